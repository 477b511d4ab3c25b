// Checks compressed meshes and bufferViews: see gltf/checker.h.
#include <fmt/format.h>

#include "libcommon/scene/gltf/checker.h"
#include "libcommon/scene/gltf/compression.h"
#include "libcommon/scene/gltf/meshopt.h"

namespace tdpt::gltf {
namespace {

/// Element sizes that meshoptimizer requires in its modes and filters.
void check_meshopt_stride(Checker& c, const Json& e, const std::string& at) {
  const auto stride = e["byteStride"].get<uint64_t>();
  const auto mode = e["mode"].get<std::string>(), filter = e.value("filter", "NONE");
  const auto expect = [&](bool right, const char* expected) {
    if (!right) c.fail(at + ".byteStride", e["byteStride"], expected);
  };
  if (mode != "ATTRIBUTES") {
    expect(stride == 2 || stride == 4, "2 or 4, the bytes of an index");
    if (filter != "NONE") c.fail(at + ".filter", e["filter"], "NONE where there are indices");
    return;
  }
  expect(stride % 4 == 0, "a multiple of 4");
  if (filter == "OCTAHEDRAL") expect(stride == 4 || stride == 8, "4 or 8 with this filter");
  if (filter == "QUATERNION") expect(stride == 8, "8 with this filter");
}

}  // namespace

void check_draco(Checker& c, Json& p, const std::string& at) {
  Json* const e = c.check_extension(
      p, at, kDraco, {index("bufferView", "bufferViews", true), object("attributes", true)});
  if (!e) return;
  Json& ids = (*e)["attributes"];
  std::erase_if(ids.get_ref<Json::object_t&>(),
                [](const auto& a) { return !is_read_attribute(a.first); });
  for (const auto& [name, value] : ids.items()) {
    c.check(ids, at + ".extensions." + kDraco + ".attributes",
            {integer(name.c_str(), true, 0, 4294967295.0)});
    if (!p["attributes"].contains(name))
      c.fail_missing(at + ".attributes." + name.substr(0, 60), "but is compressed by Draco");
  }
  if (!p.contains("indices") && p.value("mode", 4) >= 4)
    c.fail_missing(at + ".indices", "meshes compressed by Draco have some");
}

void check_meshopt_buffer(Checker& c, Json& buffer, const std::string& at) {
  for (const char* name : kMeshopt) c.check_extension(buffer, at, name, {boolean("fallback")});
}

void check_meshopt_view(Checker& c, Json& view, const std::string& at) {
  for (const char* name : kMeshopt) {
    const Json* const extension =
        c.check_extension(view, at, name,
                          {index("buffer", "buffers", true), integer("byteOffset"),
                           integer("byteLength", true, 1), integer("byteStride", true, 1, 256),
                           integer("count", true, 1), text("mode", true), text("filter")});
    if (!extension) continue;
    const Json& e = *extension;
    const std::string here = at + ".extensions." + name;
    const auto mode = e["mode"].get<std::string>(), filter = e.value("filter", "NONE");
    if (mode != "ATTRIBUTES" && mode != "TRIANGLES" && mode != "INDICES")
      c.fail(here + ".mode", e["mode"], "ATTRIBUTES, TRIANGLES or INDICES");
    if (filter != "NONE" && filter != "OCTAHEDRAL" && filter != "QUATERNION" &&
        filter != "EXPONENTIAL")
      c.fail(here + ".filter", e["filter"], "NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL");
    check_meshopt_stride(c, e, here);
    if (view.contains("byteStride") && view["byteStride"] != e["byteStride"])
      c.fail(here + ".byteStride", e["byteStride"],
             fmt::format("{} as of the bufferView", view["byteStride"].get<uint64_t>()));
    if (mode == "TRIANGLES" && e["count"].get<uint64_t>() % 3 != 0)
      c.fail(here + ".count", e["count"], "a multiple of 3");
  }
}

}  // namespace tdpt::gltf
