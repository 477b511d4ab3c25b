// NAME_replay FILE|FOLDER ...: runs a libFuzzer target on stored inputs. A failed check or an
// escaping exception ends the program; having no input at all is also a failure.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "libcommon/base/file.h"
#include "libcommon/testing/files/fuzz.h"

namespace fs = std::filesystem;

int main(int argc, char** argv) {
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    if (!fs::is_directory(argv[i])) {
      files.push_back(argv[i]);
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(argv[i]))
      if (entry.is_regular_file()) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) {
    const std::string bytes = tdpt::read_file(file);
    std::fprintf(stderr, "%s\n", file.c_str());  // the last name printed is the culprit
    LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
  }
  std::printf("%zu inputs, each read or refused\n", files.size());
  return files.empty() ? 1 : 0;
}
