#include "tools/portalfit/renderers.h"

#include <algorithm>

#include <fmt/format.h>

#include "tdpt_version.h"
#include "tools/portalfit/renderer_text.h"

namespace tdpt {
namespace {

// Of a portal's lines, the share that comes from the sky past no other portal: 0.2 to 1 of windows,
// less than 0.04 of doors within a building (doc/cycles.md).
constexpr double kOfTheSky = 0.1;

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

bool lets_in_sky(const Portal& portal) {
  const auto sky = portal.figures.find("sky");
  return sky == portal.figures.end() || sky->second >= kOfTheSky;
}

SkyPortals sky_portals(const PortalFile& file) {
  SkyPortals sorted;
  for (size_t n = 0; n < file.portals.size(); ++n) {
    Portal portal = file.portals[n];
    portal.name = fmt::format("portal.{}", n);
    (lets_in_sky(portal) ? sorted.outer : sorted.inner).push_back(std::move(portal));
  }
  return sorted;
}

std::string identifier(const Portal& portal) {
  std::string name = portal.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

std::string commented(const Portal& portal, const std::string& text, const std::string& mark) {
  std::string all = fmt::format("{}{}: no light from the sky meets it first\n", mark, portal.name);
  for (size_t at = 0; at < text.size();) {
    const size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    all += mark + text.substr(at, end - at);
    at = end;
  }
  return all;
}

std::vector<std::string> remarks_on(const PortalFile& file) {
  const auto outer =
      static_cast<size_t>(std::count_if(file.portals.begin(), file.portals.end(), lets_in_sky));
  std::vector<std::string> remarks{
      fmt::format("{} light {} by portalfit (tdpt {}), in metres",
                  file.portals.empty() ? std::string("No") : std::to_string(file.portals.size()),
                  file.portals.size() == 1 ? "portal" : "portals", TDPT_VERSION)};
  if (outer < file.portals.size())
    remarks.push_back(fmt::format("{} of them {} in the sky", outer, outer == 1 ? "lets" : "let"));
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
