#include "tools/tdpt-import/mitsuba/object.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <pugixml.hpp>
#include <set>
#include <unordered_map>

#include "libcommon/base/words.h"

namespace tdpt::foreign::mitsuba {
namespace {

constexpr int kDeepestInclude = 15, kDeepest = 64;
// Included and substituted text [bytes], which could else grow without bound.
constexpr size_t kMostText = size_t{1} << 28;

// toWorld, intIOR -> to_world, int_ior; as Mitsuba 3 does with older files.
std::string snake_case(const std::string& name) {
  std::string out;
  const auto is_upper = [](char c) { return c >= 'A' && c <= 'Z'; };
  const auto is_lower = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto lower = [](char c) { return static_cast<char>(c - 'A' + 'a'); };
  for (size_t i = 0; i < name.size(); ++i) {
    if (i == 0 || !is_upper(name[i]) || !is_lower(name[i - 1])) {
      out += name[i];
      continue;
    }
    out += '_';
    out += lower(name[i]);
    while (i + 1 < name.size() && is_upper(name[i + 1])) out += lower(name[++i]);
  }
  return out;
}

// One file while it is parsed.
struct File {
  std::string name;
  std::vector<size_t> line_ends{};
  bool old = false;

  Place place(ptrdiff_t offset) const {
    if (offset < 0) return {name, ""};
    const auto it =
        std::lower_bound(line_ends.begin(), line_ends.end(), static_cast<size_t>(offset));
    return {name, fmt::format("line {}", it - line_ends.begin() + 1)};
  }
};

class Parser {
 public:
  Parser(Source& source, const std::map<std::string, std::string>& parameters, Document& out)
      : source_(source), out_(out) {
    for (const auto& [name, value] : parameters) {
      define(name, value);
      unused_.insert("$" + name);
    }
  }

  void parse() {
    out_.objects.push_back({&source_, "scene", "scene", "", {source_.path(), ""}});
    out_.scene = &out_.objects.back();
    out_.objects.back().key = source_.enter({}, {source_.path(), ""}, "");
    read_file(source_.text(), source_.path(), 0, out_.objects.back());
    resolve();
    if (!unused_.empty())
      throw UsageError("--define: the scene does not use " + shown(*unused_.begin(), 60));
  }

 private:
  // ---- $names

  void define(const std::string& name, const std::string& value) {
    const std::string key = "$" + name;
    for (const auto& [known, ignored] : parameters_)
      if (known == key) return;
    // Longer names first: $width2 is not $width and 2.
    const auto at = std::find_if(parameters_.begin(), parameters_.end(),
                                 [&](const auto& p) { return p.first.size() < key.size(); });
    parameters_.insert(at, {key, value});
  }

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
    size_t end = left + 1;
    while (end < text.size() &&
           (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_'))
      ++end;
    Source::fail(place, "\"" + shown(text.substr(left, end - left), 60) +
                            "\" has no value: neither a default nor --define gives it one");
  }

  void take(size_t bytes, const Place& place) {
    taken_ += bytes;
    if (taken_ > kMostText) Source::fail(place, "the scene's includes and $names grow too large");
  }

  // `holder`: the key of the element.
  Attributes attributes_of(const pugi::xml_node& node, const Place& place, const Key& holder) {
    Attributes out;
    for (const pugi::xml_attribute& a : node.attributes())
      out[a.name()] = {substituted(a.value(), place),
                       source_.enter(holder, place,
                                     fmt::format("the attribute \"{}\" of a <{}> is not read",
                                                 shown(a.name(), 40), shown(node.name(), 40)))};
    return out;
  }

  // ---- files

  void read_file(const std::string& text, const std::string& shown_name, int depth, Object& into) {
    File file{shown_name};
    for (size_t at = 0; (at = text.find('\n', at)) != text.npos; ++at) file.line_ends.push_back(at);
    pugi::xml_document xml;
    const pugi::xml_parse_result result = xml.load_buffer(text.data(), text.size());
    if (!result)
      Source::fail(file.place(result.offset), fmt::format("is no XML: {}", result.description()));
    const pugi::xml_node root = xml.document_element();
    const Place place = file.place(root.offset_debug());
    if (depth == 0 && std::string(root.name()) != "scene")
      Source::fail(
          place, fmt::format("<{}> is no Mitsuba scene: expected <scene>", shown(root.name(), 40)));
    const std::string version = root.attribute("version").value();
    if (version.empty() && depth == 0) Source::fail(place, "the scene has no version");
    file.old = version.empty() ? into.old : version[0] == '0' || version[0] == '1';
    if (depth == 0) into.old = file.old, into.place = place;
    if (std::string(root.name()) == "scene") {
      for (const auto& [name, attribute] : attributes_of(root, place, {}))
        if (name == "version") attribute.key.take();
      read_children(root, file, depth, 0, into);
    } else {
      read_child(root, file, depth, 0, into);
    }
  }

  void include(const Place& place, const std::string& name, int depth, Object& into) {
    if (depth + 1 > kDeepestInclude) Source::fail(place, "includes are nested too deeply");
    const std::string text = source_.read(name, place);
    take(text.size() + 1024, place);
    read_file(text, source_.shown_name(name), depth + 1, into);
  }

  // ---- elements

  // What to say if nobody reads an element.
  static std::string missing(const pugi::xml_node& node, bool is_object, const Object& of) {
    const auto named = [&](const char* attribute) {
      const std::string word = node.attribute(attribute).value();
      return shown(word.empty() ? node.name() : word, 40);
    };
    if (is_object)
      return fmt::format("the {} \"{}\" in a {} is left out", node.name(), named("type"),
                         of.described());
    if (std::string(node.name()) == "ref")
      return fmt::format("the reference to \"{}\" in a {} is left out", named("id"),
                         of.described());
    return fmt::format("the parameter \"{}\" of the {} is not read", named("name"), of.described());
  }

  void read_children(const pugi::xml_node& node, const File& file, int includes, int depth,
                     Object& into) {
    for (const pugi::xml_node& child : node.children())
      if (child.type() == pugi::node_element) read_child(child, file, includes, depth, into);
  }

  void read_child(const pugi::xml_node& node, const File& file, int includes, int depth,
                  Object& into) {
    const Place place = file.place(node.offset_debug());
    if (depth > kDeepest) Source::fail(place, "is nested too deeply");
    Value v{&source_, node.name(), "", place};
    const bool is_object = is_one_of(v.tag,
                                     "shape bsdf texture emitter sensor medium film integrator "
                                     "sampler rfilter phase volume subsurface random scene") ||
                           (v.tag == "spectrum" && node.attribute("type"));
    v.key = source_.enter(into.key, place, missing(node, is_object, into));
    v.contents = source_.enter(v.key, place, "");
    v.attributes = attributes_of(node, place, v.contents);
    v.name = v.attributes["name"].text;
    for (const auto& [name, attribute] : v.attributes)
      if (is_one_of(name, "name id type intent"))  // RGB has no intent
        attribute.key.take();
    if (is_one_of(v.tag, "default include path alias null")) v.key.take();
    if (v.tag == "default") return define(v.text("name"), v.text());
    if (v.tag == "include") return include(place, v.text("filename"), includes, into);
    if (v.tag == "path") return source_.search(v.text(), place);
    if (v.tag == "alias") return name_object(v.text("as"), find(v.text("id"), place), place);
    if (file.old) v.name = snake_case(v.name);
    if (v.tag == "ref") {
      v.id = v.text("id");
    } else if (v.tag == "transform") {
      v.map = map_of(node, file, v.key);
    } else if (v.tag == "animation") {
      v.is_animated = true;
      v.map = map_of(node.child("transform"), file, v.key);
    } else if (is_object) {
      v.object = &read_object(node, file, includes, depth, v);
      v.tag = v.object->tag;
    } else if (v.tag == "null") {
      return;
    } else if (is_one_of(v.tag,
                         "integer float boolean string point vector rgb srgb spectrum blackbody")) {
      if (v.name.empty()) v.fail(fmt::format("a {} without a name", v.tag));
    } else {
      v.fail(fmt::format("the element <{}> is unknown", shown(v.tag, 40)));
    }
    into.values.push_back(std::move(v));
  }

  Object& read_object(const pugi::xml_node& node, const File& file, int includes, int depth,
                      const Value& v) {
    out_.objects.push_back(
        {&source_, v.tag == "spectrum" ? "texture" : v.tag, "", "", v.place, file.old});
    Object& object = out_.objects.back();
    object.key = v.contents;
    if (v.attributes.contains("type"))
      object.type = v.attributes.at("type").text;
    else if (v.tag != "bsdf")
      v.text("type");  // fails
    // Types count without case in 0.x.
    if (file.old)
      for (char& c : object.type)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    read_children(node, file, includes, depth + 1, object);
    // Some writers of Mitsuba 3 scenes leave the type of a twosided bsdf out.
    if (object.type.empty() && object.tag == "bsdf") {
      if (object.values.empty()) object.fail("the bsdf has no type");
      object.lose("a bsdf without a type is taken as twosided");
      object.type = "twosided";
    }
    if (const auto it = v.attributes.find("id"); it != v.attributes.end()) {
      object.id = it->second.text;
      name_object(object.id, &object, v.place);
    }
    return object;
  }

  Affine map_of(const pugi::xml_node& node, const File& file, const Key& holder) {
    Affine map;
    for (const pugi::xml_node& step : node.children()) {
      if (step.type() != pugi::node_element) continue;
      const Place place = file.place(step.offset_debug());
      const auto m =
          map_of_step({&source_, step.name(), "", place, attributes_of(step, place, holder)});
      if (!m)
        Source::fail(place, fmt::format("<{}> is no step of a transform", shown(step.name(), 40)));
      map = *m * map;
      if (!is_finite(map.x) || !is_finite(map.y) || !is_finite(map.z) || !is_finite(map.t))
        Source::fail(place, "the transform's numbers become too large");
    }
    return map;
  }

  // ---- ids

  void name_object(const std::string& id, const Object* object, const Place& place) {
    if (!named_.emplace(id, object).second)
      Source::fail(place, fmt::format("a second object has the id \"{}\"", shown(id, 60)));
  }

  const Object* find(const std::string& id, const Place& place) const {
    const auto it = named_.find(id);
    if (it == named_.end())
      Source::fail(place, fmt::format("no object has the id \"{}\"", shown(id, 60)));
    return it->second;
  }

  // References may come before what they name.
  void resolve() {
    for (Object& object : out_.objects)
      for (Value& v : object.values)
        if (v.tag == "ref") {
          v.object = find(v.id, v.place);
          v.tag = v.object->tag;
        }
    for (const Object& object : out_.objects) height(object, 0);
  }

  // The height of the tree below an object; a cycle is a tree that is too high.
  int height(const Object& object, int above) {
    if (above > kDeepest) object.fail("objects refer to each other too deeply, or in a circle");
    if (const auto it = heights_.find(&object); it != heights_.end()) return it->second;
    int h = 0;
    for (const Value& v : object.values)
      if (v.object) h = std::max(h, 1 + height(*v.object, above + 1));
    if (h > kDeepest) object.fail("objects refer to each other too deeply");
    return heights_[&object] = h;
  }

  Source& source_;
  Document& out_;
  std::vector<std::pair<std::string, std::string>> parameters_;  // "$name", value
  std::unordered_map<std::string, const Object*> named_;
  std::unordered_map<const Object*, int> heights_;
  std::set<std::string> unused_;  // "$name" of --define
  size_t taken_ = 0;              // of kMostText
};

}  // namespace

Document parse(Source& source, const std::map<std::string, std::string>& parameters) {
  Document out;
  Parser(source, parameters, out).parse();
  return out;
}

}  // namespace tdpt::foreign::mitsuba
