// Mitsuba 3: the emitter `portal` is the square [-1, 1] x [-1, 1] of its frame; its +Z points away
// from the environment. Documented at the head of its src/emitters/portal.cpp, which came after
// version 3.9.1; `include` in docs/src/key_topics/scene_format.rst. bench/readers.py has its parser
// read the text.
#include <fmt/format.h>

#include "tools/portalfit/renderer_text.h"
#include "tools/portalfit/renderers.h"

namespace tdpt {
namespace {

// XML comments may not contain two dashes in a row.
std::string in_comment(const std::string& text) {
  std::string spaced;
  for (const char c : text) {
    if (c == '-' && spaced.ends_with('-')) spaced += ' ';
    spaced += c;
  }
  return spaced;
}

std::string emitter(const Portal& portal) {
  const Rectangle r = rectangle_of(portal);
  const Placement p{r.x * (0.5 * r.width), r.y * (0.5 * r.height), r.normal, r.centre};
  std::vector<double> matrix;
  for (const auto& row : p.rows()) matrix.insert(matrix.end(), row.begin(), row.end());
  return fmt::format(
      "    <emitter type=\"portal\" id=\"{}\">\n"
      "        <transform name=\"to_world\">\n"
      "            <matrix value=\"{}\"/>\n"
      "        </transform>\n"
      "    </emitter>\n",
      identifier(portal), numbers(matrix));
}

}  // namespace

std::string portals_for_mitsuba(const PortalFile& file) {
  std::string text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n";
  for (const std::string& remark : remarks_on(file))
    text += fmt::format("<!-- {} -->\n", in_comment(remark));
  text +=
      "<!-- Mitsuba 3 with the emitter \"portal\", which its sources have since September 2026 "
      "and\n"
      "     version 3.9.1 lacks:\n"
      "     <include filename=\"portals.xml\"/> in the scene, beside its envmap or constant. -->\n"
      "<scene version=\"3.0.0\">\n";
  const SkyPortals portals = sky_portals(file);
  for (const Portal& portal : portals.outer) text += emitter(portal);
  for (const Portal& portal : portals.inner)
    text += "    <!--\n" + commented(portal, emitter(portal), "") + "    -->\n";
  return text + "</scene>\n";
}

}  // namespace tdpt
