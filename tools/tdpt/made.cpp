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
#include "libcommon/base/shown.h"

namespace tdpt {
namespace {

using Json = nlohmann::json;

constexpr size_t kMostMakers = 32;  // requests stored per picture
const std::string kPreview = "--preview";

// Words may hold invalid UTF-8; comparisons use the stored form.
Json as_kept(const Words& words) {
  const Json json(words);
  return Json::parse(json.dump(-1, ' ', true, Json::error_handler_t::replace));
}

Json json_of(const Made& made) {
  return {{"identity", as_kept(made.identity)},
          {"key", made.key},
          {"whole", made.whole},
          {"beside", made.beside}};
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
      all.push_back({one.at("identity").get<Words>(), one.at("key").get<std::string>(),
                     one.at("whole").get<bool>(),
                     one.at("beside").get<std::map<std::string, std::string>>()});
    } catch (const Json::exception&) {  // of another version, or damaged
    }
  return all;
}

void keep(const Made& made, const std::string& hash, const WorkFolder& work) {
  Made kept = made;
  Json all = Json::array();
  const Json identity = as_kept(made.identity);
  for (const Made& before : made_of(hash, work)) {
    if (Json(before.identity) != identity)
      all.push_back(json_of(before));
    else if (before.key == made.key)
      kept.beside.insert(before.beside.begin(), before.beside.end());
  }
  if (all.size() >= kMostMakers) all.erase(all.begin());
  all.push_back(json_of(kept));
  work.make();
  if (!work.know(hash, all.dump() + "\n"))
    throw OutputError(work.path_of("known-" + hash), "cannot be written");
}

void keep(const Unfinished& unfinished, const std::string& entry) {
  write_output(entry + "/unfinished", unfinished.key + "\n");
}

std::optional<Unfinished> unfinished_in(const std::string& entry) {
  try {
    const std::string text = read_file(entry + "/unfinished");
    return Unfinished{text.substr(0, text.find('\n'))};
  } catch (const InputError&) {
    return {};
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

void check_owner(const Request& request, const WorkFolder& work) {
  const std::string hash = hash_of_picture(request.picture);
  if (hash.empty()) return;
  const std::vector<Made> all = made_of(hash, work);
  if (all.empty())
    throw UsageError(request.picture +
                     ": is there already, and tdpt did not make it; --force replaces it");
  const Json now = as_kept(request.identity);
  for (const Made& made : all)
    if (Json(made.identity) == now) return;
  throw UsageError(fmt::format("{}: another command made it, {}; --force replaces it",
                               request.picture,
                               shown(difference(all.back().identity, request.identity), 200)));
}

}  // namespace tdpt
