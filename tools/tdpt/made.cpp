#include "tools/tdpt/made.h"

#include <filesystem>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/base/hash.h"
#include "libcommon/base/shown.h"

namespace tdpt {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

bool is_there(const std::string& path) {
  std::error_code failed;
  return fs::is_regular_file(path, failed);
}

}  // namespace

std::optional<Made> made_of(const std::string& picture, const WorkFolder& work) {
  if (!is_there(picture)) return {};
  const auto known = work.known(content_hash_of_file(picture));
  return known ? parse_made(*known) : std::nullopt;
}

std::string text_of(const Made& made) {
  const Json json{{"identity", made.identity},
                  {"key", made.key},
                  {"whole", made.whole},
                  {"beside", made.beside}};
  return json.dump(-1, ' ', true, Json::error_handler_t::replace) + "\n";
}

std::optional<Made> parse_made(const std::string& text) {
  const Json json = Json::parse(text, nullptr, false);
  try {
    if (!json.is_object()) return {};
    return Made{json.at("identity").get<Words>(), json.at("key").get<std::string>(),
                json.at("whole").get<bool>(),
                json.at("beside").get<std::map<std::string, std::string>>()};
  } catch (const Json::exception&) {
    return {};
  }
}

std::map<std::string, std::string> files_written_beside(const RenderArguments& a) {
  std::map<std::string, std::string> hashes;
  for (const auto& [option, path] :
       {std::pair("--preview", a.preview), {"--stats", a.stats}, {"--nonzero", a.nonzero}})
    if (is_there(path)) hashes[option] = content_hash_of_file(path);
  return hashes;
}

bool is_fresh(const Arguments& a, const Request& request, const Pipeline& p,
              const WorkFolder& work) {
  if (!p.repeatable || !is_there(request.picture)) return false;
  const auto made = made_of(request.picture, work);
  if (!made || made->key != p.key || !made->whole) return false;
  const auto beside = files_written_beside(a);
  for (const auto& [option, path] :
       {std::pair("--preview", a.preview), {"--stats", a.stats}, {"--nonzero", a.nonzero}}) {
    if (path.empty()) continue;
    const auto now = beside.find(option), then = made->beside.find(option);
    if (now == beside.end() || then == made->beside.end() || now->second != then->second)
      return false;
  }
  return true;
}

std::optional<Made> unfinished(const Pipeline& p, const WorkFolder& work) {
  const std::string path = work.path_of(p.picture_entry) + "/made";
  return is_there(path) ? parse_made(read_file(path)) : std::nullopt;
}

void check_owner(const Request& request, const Pipeline& p, const WorkFolder& work) {
  if (!is_there(request.picture)) return;
  std::optional<Made> made = made_of(request.picture, work);
  if (!made) made = unfinished(p, work);
  if (!made)
    throw UsageError(request.picture +
                     ": is there already, and tdpt did not make it; --force replaces it");
  // As they are kept.
  const auto now = parse_made(text_of({request.identity, "", true, {}}));
  if (now && made->identity == now->identity) return;
  throw UsageError(fmt::format("{}: another command made it, {}; --force replaces it",
                               request.picture,
                               shown(difference(made->identity, request.identity), 200)));
}

}  // namespace tdpt
