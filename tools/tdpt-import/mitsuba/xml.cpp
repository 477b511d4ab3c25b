#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>
#include <unordered_map>

#include "libcommon/base/words.h"
#include "tools/tdpt-import/mitsuba/mitsuba.h"

namespace tdpt::foreign::mitsuba {
namespace {

constexpr int kDeepestInclude = 15, kDeepest = 64;
// The most included and substituted text [bytes]; without a limit it could grow exponentially.
constexpr size_t kMostText = size_t{1} << 28;

// Converts toWorld and intIOR to to_world and int_ior, as Mitsuba 3 does with older files.
std::string snake_case(const std::string& name) {
  std::string out;
  for (size_t i = 0; i < name.size(); ++i) {
    if (i > 0 && name[i] >= 'A' && name[i] <= 'Z' && name[i - 1] >= 'a' && name[i - 1] <= 'z')
      out += '_';
    out += name[i];
  }
  return lower_case(out);
}

// A file that is being parsed.
struct File {
  std::string name;
  int includes = 0;  // how many includes lead to it
  std::vector<size_t> line_ends{};
  bool old = false;

  Place place(ptrdiff_t offset) const {
    if (offset < 0) return {name, ""};
    const auto it =
        std::lower_bound(line_ends.begin(), line_ends.end(), static_cast<size_t>(offset));
    return {name, fmt::format("line {}", it - line_ends.begin() + 1)};
  }
};

struct LongerFirst {
  bool operator()(const std::string& a, const std::string& b) const {
    return a.size() != b.size() ? a.size() > b.size() : a < b;
  }
};

class Parser {
 public:
  Parser(Source& source, const std::map<std::string, std::string>& parameters) : source_(source) {
    for (const auto& [name, value] : parameters) {
      parameters_["$" + name] = value;
      unused_.insert("$" + name);
    }
  }

  std::deque<Element> parse() {
    Element& scene = elements_.emplace_back(Element{&source_, "scene", {source_.path(), ""}});
    scene.type = "scene";
    scene.contents = source_.enter({}, scene.place, "");
    read_file(source_.text(), source_.path(), 0, scene);
    resolve();
    if (!unused_.empty())
      throw UsageError("--define: the scene does not use " + shown(*unused_.begin(), 60));
    return std::move(elements_);
  }

 private:
  std::string substituted(std::string text, const Place& place) {
    if (text.find('$') == text.npos) return text;
    for (const auto& [key, value] : parameters_)
      for (size_t at = 0; (at = text.find(key, at)) != text.npos; at += value.size()) {
        unused_.erase(key);
        text.replace(at, key.size(), value);
        if (text.size() > kMostText) Source::fail(place, "a value that is too long");
      }
    take(text.size(), place);
    const size_t left = text.find('$');
    if (left == text.npos) return text;
    Source::fail(place, "\"" + shown(text.substr(left), 60) +
                            "\" has no value: neither a default nor --define gives it one");
  }

  void take(size_t bytes, const Place& place) {
    taken_ += bytes;
    if (taken_ > kMostText) Source::fail(place, "the scene's includes and $names grow too large");
  }

  void read_file(const std::string& text, const std::string& name, int includes, Element& into) {
    File file{name, includes};
    for (size_t at = 0; (at = text.find('\n', at)) != text.npos; ++at) file.line_ends.push_back(at);
    pugi::xml_document xml;
    const pugi::xml_parse_result result = xml.load_buffer(text.data(), text.size());
    if (!result)
      Source::fail(file.place(result.offset), fmt::format("is no XML: {}", result.description()));
    const pugi::xml_node root = xml.document_element();
    const Place place = file.place(root.offset_debug());
    const bool is_scene = std::string(root.name()) == "scene";
    const std::string version = root.attribute("version").value();
    file.old = version.empty() ? into.old : version[0] == '0' || version[0] == '1';
    if (includes == 0) {
      if (!is_scene)
        Source::fail(place, fmt::format("<{}> is no Mitsuba scene: expected <scene>",
                                        shown(root.name(), 40)));
      if (version.empty()) Source::fail(place, "the scene has no version");
      into.old = file.old, into.place = place;
    }
    if (is_scene)
      read_children(root, file, 0, into);
    else
      read_child(root, file, 0, into);
  }

  void include(const Place& place, const std::string& name, int includes, Element& into) {
    if (includes > kDeepestInclude) Source::fail(place, "includes are nested too deeply");
    const std::string text = source_.read(name, place);
    take(text.size() + 1024, place);
    read_file(text, source_.shown_name(name), includes, into);
  }

  // An element without its children, not yet added to its parent.
  Element element_of(const pugi::xml_node& node, const File& file) {
    Element out{&source_, node.name(), file.place(node.offset_debug()), file.old};
    for (const pugi::xml_attribute& a : node.attributes())
      out.attributes[a.name()] = substituted(a.value(), out.place);
    out.name = out.optional("name");
    return out;
  }

  void read_children(const pugi::xml_node& node, const File& file, int depth, Element& into) {
    for (const pugi::xml_node& child : node.children())
      if (child.type() == pugi::node_element) read_child(child, file, depth, into);
  }

  void read_child(const pugi::xml_node& node, const File& file, int depth, Element& into) {
    Element e = element_of(node, file);
    if (depth > kDeepest) e.fail("is nested too deeply");
    if (e.tag == "default") {
      parameters_.emplace("$" + e.attribute("name"), e.attribute());
      return;
    }
    if (e.tag == "include")
      return include(e.place, e.attribute("filename"), file.includes + 1, into);
    if (e.tag == "path") return source_.search(e.attribute(), e.place);
    if (e.tag == "alias")
      return name_object(e.attribute("as"), find(e.attribute("id"), e.place), e.place);
    if (e.tag == "null") return;

    if (file.old) e.name = snake_case(e.name);
    if (e.tag == "ref") {
      e.id = e.attribute("id");
      add(std::move(e), "id", into);
      return;
    }
    if (e.tag == "transform") {
      e.map = map_of(node, file);
    } else if (e.tag == "animation") {
      e.is_animated = true;
      e.map = map_of(node.child("transform"), file);
    } else if (is_one_of(e.tag,
                         "shape bsdf texture emitter sensor medium film integrator sampler rfilter "
                         "phase volume subsurface random scene") ||
               (e.tag == "spectrum" && e.attributes.contains("type"))) {
      return read_object(node, file, depth, std::move(e), into);
    } else if (!is_one_of(
                   e.tag,
                   "integer float boolean string point vector rgb srgb spectrum blackbody")) {
      e.fail(fmt::format("the element <{}> is unknown", shown(e.tag, 40)));
    } else if (e.name.empty()) {
      e.fail(fmt::format("a {} without a name", e.tag));
    }
    add(std::move(e), "name", into);
  }

  // `called`: the attribute that names the element in the message that it is not read. Parameters
  // of sampling do not change the picture, so there is no message for them.
  Element& add(Element&& e, const char* called, Element& into) {
    const std::string what = e.tag == "ref" ? "reference" : e.tag, word = e.optional(called);
    const bool is_parameter = called == std::string("name");
    e.key = source_.enter(
        into.contents, e.place,
        is_parameter && e.name.find("sampl") != e.name.npos
            ? ""
            : fmt::format("the {} \"{}\" of the {} is not read", is_parameter ? "parameter" : what,
                          shown(word.empty() ? e.tag : word, 40), into.described()));
    into.children.push_back(&elements_.emplace_back(std::move(e)));
    return elements_.back();
  }

  void read_object(const pugi::xml_node& node, const File& file, int depth, Element&& e,
                   Element& into) {
    Element& object = add(std::move(e), "type", into);
    object.object = &object;
    object.contents = source_.enter(object.key, object.place, "");
    if (object.tag == "spectrum") object.tag = "texture";
    // Types count without case in 0.x.
    if (object.tag != "bsdf" || object.attributes.contains("type"))
      object.type = file.old ? lower_case(object.attribute("type")) : object.attribute("type");
    read_children(node, file, depth + 1, object);
    // Some writers of Mitsuba 3 scenes leave the type of a twosided bsdf out.
    if (object.type.empty() && object.tag == "bsdf") {
      if (object.children.empty()) object.fail("the bsdf has no type");
      object.lose("a bsdf without a type is taken as twosided");
      object.type = "twosided";
    }
    object.id = object.optional("id");
    if (object.attributes.contains("id")) name_object(object.id, &object, object.place);
  }

  Affine map_of(const pugi::xml_node& node, const File& file) {
    Affine map;
    for (const pugi::xml_node& child : node.children()) {
      if (child.type() != pugi::node_element) continue;
      const Element step = element_of(child, file);
      const auto m = map_of_step(step);
      if (!m) step.fail(fmt::format("<{}> is no step of a transform", shown(step.tag, 40)));
      map = *m * map;
      if (!is_finite(map.x) || !is_finite(map.y) || !is_finite(map.z) || !is_finite(map.t))
        step.fail("the transform's numbers become too large");
    }
    return map;
  }

  void name_object(const std::string& id, const Element* object, const Place& place) {
    if (!named_.emplace(id, object).second)
      Source::fail(place, fmt::format("a second object has the id \"{}\"", shown(id, 60)));
  }

  const Element* find(const std::string& id, const Place& place) const {
    const auto it = named_.find(id);
    if (it == named_.end())
      Source::fail(place, fmt::format("no object has the id \"{}\"", shown(id, 60)));
    return it->second;
  }

  // References may come before what they name.
  void resolve() {
    for (Element& e : elements_)
      if (e.tag == "ref") {
        e.object = find(e.id, e.place);
        e.tag = e.object->tag;
      }
    for (const Element& e : elements_) height(e, 0);
  }

  // The height of the tree below an object; a cycle is a tree that is too high.
  int height(const Element& object, int above) {
    if (above > kDeepest) object.fail("objects refer to each other too deeply, or in a circle");
    if (const auto it = heights_.find(&object); it != heights_.end()) return it->second;
    int h = 0;
    for (const Element* e : object.children)
      if (e->object) h = std::max(h, 1 + height(*e->object, above + 1));
    if (h > kDeepest) object.fail("objects refer to each other too deeply");
    return heights_[&object] = h;
  }

  Source& source_;
  std::deque<Element> elements_{};
  // Values by "$name"; longer names come first, since $width2 is not $width followed by 2.
  std::map<std::string, std::string, LongerFirst> parameters_{};
  std::unordered_map<std::string, const Element*> named_{};
  std::unordered_map<const Element*, int> heights_{};
  std::set<std::string> unused_{};  // each "$name" of --define that is not used so far
  size_t taken_ = 0;                // included and substituted so far [bytes]
};

}  // namespace

std::deque<Element> parse(Source& source, const std::map<std::string, std::string>& parameters) {
  return Parser(source, parameters).parse();
}

}  // namespace tdpt::foreign::mitsuba
