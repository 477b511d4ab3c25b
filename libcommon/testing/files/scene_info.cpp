// scene_info SCENE: prints what read_gltf() reads, for end-to-end tests without a tool.
#include <fmt/format.h>

#include "libcommon/cli/cli.h"
#include "libcommon/scene/scene.h"

int main(int argc, char** argv) {
  using namespace tdpt;
  cli::Options options({"scene_info", "Says what a scene holds.", nullptr});
  std::string path;
  options.argument("SCENE", path, "glTF 2.0 scene");
  return options.run_main(argc, argv, [&] {
    const Scene scene = read_gltf(path);
    for (const std::string& w : scene.warnings) options.common.warn(w);
    fmt::print("triangles {}\nmaterials {}\ncameras {}\n", scene.triangles.size(),
               scene.materials.size(), scene.cameras.size());
    return 0;
  });
}
