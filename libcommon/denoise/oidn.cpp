#include "libcommon/denoise/oidn.h"

#include <dlfcn.h>
#include <glob.h>

#include <cstdlib>

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>

#include "libcommon/base/error.h"

namespace tdpt::denoise {
namespace {

constexpr int kCpu = 1, kFloat3 = 3;  // OIDN_DEVICE_TYPE_CPU, OIDN_FORMAT_FLOAT3

// Names for the loader, then files of the Python package pyoidn.
std::vector<std::string> places() {
  std::vector<std::string> all{"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1",
                               "libOpenImageDenoise.so.0", "libOpenImageDenoise.so"};
  std::vector<std::string> roots{"/usr/local", "/usr"};
  if (const char* home = std::getenv("HOME"))
    roots.insert(roots.begin(), std::string(home) + "/.local");
  if (const char* environment = std::getenv("VIRTUAL_ENV"))
    roots.insert(roots.begin(), environment);
  for (const std::string& root : roots) {
    glob_t found{};
    const std::string files =
        root + "/lib/python3*/*-packages/pyoidn/oidn/lib/libOpenImageDenoise.so.*";
    if (glob(files.c_str(), 0, nullptr, &found) == 0)
      all.insert(all.end(), found.gl_pathv, found.gl_pathv + found.gl_pathc);
    globfree(&found);
  }
  return all;
}

}  // namespace

struct OpenImageDenoise::Library {
  void* handle = nullptr;
  void* (*new_device)(int);
  void (*commit_device)(void*);
  void (*release_device)(void*);
  int (*error)(void*, const char**);
  int (*get_int)(void*, const char*);
  void (*set_device_int)(void*, const char*, int);
  void* (*new_filter)(void*, const char*);
  void (*set_image)(void*, const char*, void*, int, size_t, size_t, size_t, size_t, size_t);
  void (*set_bool)(void*, const char*, bool);
  void (*commit_filter)(void*);
  void (*execute)(void*);
  void (*release_filter)(void*);
  void* device = nullptr;

  ~Library() {
    if (device) release_device(device);
    if (handle) dlclose(handle);
  }

  // Functions were renamed in version 2.
  template <class Function>
  void find(Function& function, const char* name, const char* older = nullptr) {
    void* found = dlsym(handle, name);
    if (!found && older) found = dlsym(handle, older);
    if (!found)
      throw Error(Exit::no_device, fmt::format("Open Image Denoise has no function {}", name));
    function = reinterpret_cast<Function>(found);
  }
  void find_all() {
    find(new_device, "oidnNewDevice");
    find(commit_device, "oidnCommitDevice");
    find(release_device, "oidnReleaseDevice");
    find(error, "oidnGetDeviceError");
    find(get_int, "oidnGetDeviceInt", "oidnGetDevice1i");
    find(set_device_int, "oidnSetDeviceInt", "oidnSetDevice1i");
    find(new_filter, "oidnNewFilter");
    find(set_image, "oidnSetSharedFilterImage");
    find(set_bool, "oidnSetFilterBool", "oidnSetFilter1b");
    find(commit_filter, "oidnCommitFilter");
    find(execute, "oidnExecuteFilter");
    find(release_filter, "oidnReleaseFilter");
  }
  void check() const {
    const char* message = nullptr;
    if (error(device, &message) != 0)
      throw Error(Exit::no_device,
                  fmt::format("Open Image Denoise: {}", message ? message : "failed"));
  }
};

OpenImageDenoise::OpenImageDenoise() : library_(std::make_unique<Library>()) {
  Library& oidn = *library_;
  for (const std::string& place : places())
    if (!oidn.handle) oidn.handle = dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!oidn.handle)
    throw Error(Exit::no_device,
                "--denoiser oidn: Open Image Denoise is not installed; the Python package pyoidn "
                "has it (pip install pyoidn), or https://www.openimagedenoise.org");
  oidn.find_all();
  oidn.device = oidn.new_device(kCpu);
  if (!oidn.device) throw Error(Exit::no_device, "Open Image Denoise does not run on this CPU");
  const auto threads =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  oidn.set_device_int(oidn.device, "numThreads", static_cast<int>(threads));
  oidn.commit_device(oidn.device);
  oidn.check();
  const int version = oidn.get_int(oidn.device, "version");
  version_ = fmt::format("{}.{}.{}", version / 10000, version / 100 % 100, version % 100);
}

OpenImageDenoise::~OpenImageDenoise() = default;

std::vector<Rgb> OpenImageDenoise::filter(const Picture& noisy, const std::vector<Rgb>& albedo,
                                          const std::vector<Rgb>& normal) {
  const Library& oidn = *library_;
  const auto width = static_cast<size_t>(noisy.width), height = static_cast<size_t>(noisy.height);
  std::vector<Rgb> filtered(noisy.pixels.size());
  void* filter = oidn.new_filter(oidn.device, "RT");
  const auto image = [&](const char* name, const std::vector<Rgb>& pixels) {
    static_assert(sizeof(Rgb) == 3 * sizeof(float));
    if (pixels.empty()) return;
    oidn.set_image(filter, name, const_cast<Rgb*>(pixels.data()), kFloat3, width, height, 0, 0, 0);
  };
  image("color", noisy.pixels);
  image("albedo", albedo);
  if (!albedo.empty()) image("normal", normal);  // it takes none without albedo
  image("output", filtered);
  oidn.set_bool(filter, "hdr", true);
  oidn.set_bool(filter, "cleanAux", !albedo.empty());
  oidn.commit_filter(filter);
  oidn.execute(filter);
  oidn.release_filter(filter);
  oidn.check();
  return filtered;
}

}  // namespace tdpt::denoise
