// A stand-in for Open Image Denoise 1.4 in tests: halves the colours. It has those functions that
// are used, by the names of that version, and fails for pictures one pixel wide.
#include <cstddef>
#include <map>
#include <string>

namespace {

struct Filter {
  std::map<std::string, float*> images;
  std::map<std::string, bool> flags;
  size_t width = 0, height = 0;
};
int device;
bool failed = false;

}  // namespace

extern "C" {
void* oidnNewDevice(int) {
  return &device;
}
void oidnCommitDevice(void*) {}
void oidnReleaseDevice(void*) {}
int oidnGetDeviceError(void*, const char** message) {
  *message = "too narrow";
  const bool error = failed;
  failed = false;
  return error;
}
int oidnGetDevice1i(void*, const char*) {
  return 10403;
}
void oidnSetDevice1i(void*, const char*, int) {}
void* oidnNewFilter(void*, const char*) {
  return new Filter;
}
void oidnSetSharedFilterImage(void* filter, const char* name, void* pixels, int, size_t width,
                              size_t height, size_t, size_t, size_t) {
  auto& f = *static_cast<Filter*>(filter);
  f.images[name] = static_cast<float*>(pixels);
  f.width = width;
  f.height = height;
}
void oidnSetFilter1b(void* filter, const char* name, bool on) {
  static_cast<Filter*>(filter)->flags[name] = on;
}
void oidnCommitFilter(void*) {}
void oidnExecuteFilter(void* filter) {
  auto& f = *static_cast<Filter*>(filter);
  failed = f.width == 1 || !f.flags["hdr"] || f.flags["cleanAux"] != (f.images.count("albedo") > 0);
  for (size_t i = 0; i < 3 * f.width * f.height; ++i)
    f.images["output"][i] = f.images["color"][i] / 2;
}
void oidnReleaseFilter(void* filter) {
  delete static_cast<Filter*>(filter);
}
}
