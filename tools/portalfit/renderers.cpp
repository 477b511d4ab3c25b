#include "tools/portalfit/renderers.h"

#include <fmt/format.h>

#include "tdpt_version.h"
#include "tools/portalfit/renderer_text.h"

namespace tdpt {
namespace {

std::string plain(std::string text) {
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

}  // namespace

std::vector<std::string> renderer_names() {
  std::vector<std::string> names;
  for (const Renderer& r : kRenderers) names.push_back(r.name);
  return names;
}

std::string portals_for(const std::string& renderer, const PortalFile& file) {
  for (const Renderer& r : kRenderers)
    if (renderer == r.name) return r.text(file);
  return {};
}

std::vector<std::string> remarks_on(const PortalFile& file) {
  std::vector<std::string> remarks{
      fmt::format("{} light {} by portalfit (tdpt {}), in metres",
                  file.portals.empty() ? std::string("No") : std::to_string(file.portals.size()),
                  file.portals.size() == 1 ? "portal" : "portals", TDPT_VERSION)};
  if (!file.scene_hash.empty()) remarks.push_back(plain("scene " + file.scene_hash));
  for (const std::string& line : file.provenance.lines) remarks.push_back(plain(line));
  return remarks;
}

std::string numbers(const std::vector<double>& values, const char* between) {
  std::string text;
  for (const double v : values) text += fmt::format("{}{}", text.empty() ? "" : between, v + 0.0);
  return text;
}

std::vector<std::vector<double>> Placement::rows() const {
  std::vector<std::vector<double>> rows;
  for (int i = 0; i < 3; ++i) rows.push_back({x[i], y[i], z[i], origin[i]});
  rows.push_back({0, 0, 0, 1});
  return rows;
}

Placement shining_along_minus_z(const Rectangle& r) {
  return {r.x, -r.y, -r.normal, r.centre};
}

}  // namespace tdpt
