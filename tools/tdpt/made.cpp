#include "tools/tdpt/made.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/hash.h"
#include "libcommon/base/output_file.h"

namespace tdpt {
namespace {

using Json = nlohmann::json;

constexpr size_t kMostMakers = 32;  // keys stored per picture
const std::string kPreview = "--preview";

Json json_of(const Made& made) {
  return {{"key", made.key}, {"whole", made.whole}, {"beside", made.beside}};
}

std::string film_record(const Pipeline& p) {
  return p.film_key + "\n" + p.key + "\n";
}

std::vector<std::pair<std::string, std::string>> files_beside(const RenderArguments& a) {
  return {{kPreview, a.preview}, {"--stats", a.stats}, {"--set nonzero", a.nonzero}};
}

// Whether the file that an option names is as it was written with the picture.
bool is_as_written(const std::string& option, const RenderArguments& a, const Made& made) {
  const auto now = files_written_beside(a);
  const auto is = now.find(option), was = made.beside.find(option);
  return is != now.end() && was != made.beside.end() && is->second == was->second;
}

// All but the preview, which can be made of the picture.
bool all_are_there(const RenderArguments& a, const Made& made) {
  for (const auto& [option, path] : files_beside(a))
    if (!path.empty() && option != kPreview && !is_as_written(option, a, made)) return false;
  return true;
}

template <class Also>
bool has_made(const Request& request, const Pipeline& p, const WorkFolder& work, const Also& also) {
  const std::vector<Made> all = made_of(hash_of_picture(request.picture), work);
  return std::any_of(all.begin(), all.end(), [&](const Made& made) {
    return made.whole && made.key == p.key && also(made);
  });
}

}  // namespace

std::vector<Made> made_of(const std::string& hash, const WorkFolder& work) {
  std::vector<Made> all;
  const auto text = hash.empty() ? std::nullopt : work.known(hash);
  const Json json = Json::parse(text.value_or(""), nullptr, false);
  if (!json.is_array()) return all;
  for (const Json& one : json) try {
      all.push_back({one.at("key").get<std::string>(), one.at("whole").get<bool>(),
                     one.at("beside").get<std::map<std::string, std::string>>()});
    } catch (const Json::exception&) {  // of another version, or damaged
    }
  return all;
}

void keep(const Made& made, const std::string& hash, const WorkFolder& work) {
  Made kept = made;
  Json all = Json::array();
  for (const Made& before : made_of(hash, work)) {
    if (before.key != made.key)
      all.push_back(json_of(before));
    else
      kept.beside.insert(before.beside.begin(), before.beside.end());
  }
  if (all.size() >= kMostMakers) all.erase(all.begin());
  all.push_back(json_of(kept));
  work.make();
  if (!work.know(hash, all.dump() + "\n"))
    throw OutputError(work.path_of("known-" + hash), "cannot be written");
}

void keep_film_of(const Pipeline& p, const std::string& entry) {
  write_output(entry + "/film-of", film_record(p));
}

bool goes_on(const Pipeline& p, const std::string& entry) {
  try {
    const std::string text = read_file(entry + "/film-of");
    return text == film_record(p) || (p.counts_samples && text.starts_with(p.film_key + "\n"));
  } catch (const InputError&) {
    return false;
  }
}

std::string hash_of_picture(const std::string& path) {
  std::error_code failed;
  return std::filesystem::is_regular_file(path, failed) ? content_hash_of_file(path) : "";
}

std::map<std::string, std::string> files_written_beside(const RenderArguments& a) {
  std::map<std::string, std::string> hashes;
  for (const auto& [option, path] : files_beside(a))
    if (std::string hash = hash_of_picture(path); !hash.empty()) hashes[option] = std::move(hash);
  if (const auto preview = hashes.find(kPreview); preview != hashes.end() && a.exposure)
    preview->second += fmt::format(" {}", *a.exposure);
  return hashes;
}

bool is_fresh(const Arguments& a, const Request& request, const Pipeline& p,
              const WorkFolder& work) {
  return p.repeatable &&
         has_made(request, p, work, [&](const Made& made) { return all_are_there(a, made); });
}

bool preview_is_fresh(const Arguments& a, const Request& request, const Pipeline& p,
                      const WorkFolder& work) {
  return a.preview.empty() || has_made(request, p, work, [&](const Made& made) {
           return is_as_written(kPreview, a, made);
         });
}

std::string frame_mark_in(const std::string& path) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed)) return "";
  // The attribute as it stands in the header of an OpenEXR file: its name, its type, and its size
  // in four bytes, of which the first is enough.
  constexpr std::string_view kAttribute("frame\0string", 13);
  const std::string bytes = read_file(path);
  const size_t at = bytes.find(kAttribute), text = at + kAttribute.size() + 4;
  if (at == std::string::npos || text > bytes.size()) return "";
  return bytes.substr(text, static_cast<unsigned char>(bytes[text - 4]));
}

void check_is_frame(const std::string& path) {
  std::error_code failed;
  if (std::filesystem::is_regular_file(path, failed) && frame_mark_in(path).empty())
    throw UsageError(path + ": is there already, and is no frame of a shot; --force replaces it");
}

void check_is_ours(const std::string& picture, const WorkFolder& work) {
  const std::string hash = hash_of_picture(picture);
  if (!hash.empty() && made_of(hash, work).empty())
    throw UsageError(picture + ": is there already, and tdpt did not make it; --force replaces it");
}

}  // namespace tdpt
