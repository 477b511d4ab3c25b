// Reads and writes cut files. Grammar: man 5 cut. Nodes come before their faces and before the arcs
// between them.
#include "libcommon/formats/cut.h"

#include <iterator>

#include "libcommon/base/file.h"
#include "libcommon/formats/patch_lines.h"

namespace tdpt {
namespace {
using namespace patch_lines;

class CutReader {
 public:
  CutReader(std::string_view text, const std::string& file) : in_(text, file) {}

  CutFile read() {
    in_.expect_text("a cut file from mincut");
    if (!in_.next() || in_.word() != "c" || in_.word() != "tdpt" || in_.word() != "cut")
      in_.fail_file(fmt::format("is no cut file, expected it to start with 'c tdpt cut {}'",
                                format_version::cut));
    in_.expect_version(format_version::cut);
    in_.expect_whole_lines();
    while (in_.next()) {
      if (has_end_) in_.fail("a line behind the 'e' line, expected the end of the file");
      line(in_.word());
    }
    finish();
    return std::move(out_);
  }

 private:
  void line(std::string_view key) {
    if (key == "c") return comment();
    if (key == "s") return value();
    if (key == "n" || key == "k") return node(key == "k");
    if (key == "f") return patches_.faces();
    if (key == "a") return arc();
    if (key == "e") return end();
    in_.fail(TextLines::found(key) +
             " at the start of the line, expected one of c, s, n, k, f, a, e");
  }

  void value() {
    if (!out_.patches.empty()) in_.fail("an 's' line behind a node, expected it before");
    if (out_.cuts.size() == kMostCuts)
      in_.fail(fmt::format("one cut more than {}, expected no more", kMostCuts));
    Bottleneck cut;
    cut.flow = in_.real("value of the cut");
    if (cut.flow < 0) in_.fail("a negative cut, expected a value of 0 or more");
    cut.conductance = in_.real("conductance of the cut");
    if (cut.conductance < 0) in_.fail("a negative conductance, expected 0 or more");
    if (in_.more())
      cut.camera = static_cast<uint32_t>(
          in_.integer("camera of the cut", 1, static_cast<int64_t>(out_.number_of_cameras())) - 1);
    in_.end();
    out_.cuts.push_back(cut);
  }

  // One digit for each cut.
  uint64_t read_sides() {
    const std::string_view word = in_.word();
    if (word.size() != out_.cuts.size() || word.find_first_not_of("01") != word.npos)
      in_.fail(fmt::format("{} as sides of the cuts, expected {} of the digits 0 and 1",
                           TextLines::found(word), out_.cuts.size()));
    uint64_t sides = 0;
    for (size_t c = 0; c < word.size(); ++c) sides |= uint64_t{word[c] == '1'} << c;
    return sides;
  }

  void comment() {
    if (patches_.comment() != "bottleneck") return;
    const std::string_view answer = in_.word();
    if (answer != "yes" && answer != "no")
      in_.fail(TextLines::found(answer) + " as bottleneck, expected yes or no");
    has_bottleneck_ = true;
    out_.bottleneck = answer == "yes";
    out_.reason = std::string(in_.rest());
  }

  void node(bool sky) {
    const uint32_t node = patches_.node("node");
    out_.sides.push_back(read_sides());
    if (!in_.more())
      in_.fail("a node without geometry, expected the cut of a network made by ffgraph");
    patches_.geometry(node, sky);
  }

  void arc() {
    CutArc a{};
    a.from = patches_.patch_above("tail of an arc");
    a.to = patches_.patch_above("head of an arc");
    if (out_.crossed(a) == 0)
      in_.fail("an arc that crosses no cut, expected one from a light's side to a camera's");
    a.capacity = in_.real("capacity");
    if (!(a.capacity > 0)) in_.fail("a capacity of 0 or less, expected one above 0");
    in_.end();
    out_.arcs.push_back(a);
  }

  void end() {
    const int64_t nodes = in_.integer("number of nodes", 0, UINT32_MAX);
    const int64_t arcs = in_.integer("number of arcs", 0, UINT32_MAX);
    in_.end();
    if (nodes != std::ssize(out_.patches) || arcs != std::ssize(out_.arcs))
      in_.fail(fmt::format("{} nodes and {} arcs above, expected the {} and {} of this line",
                           out_.patches.size(), out_.arcs.size(), nodes, arcs));
    has_end_ = true;
  }

  void finish() {
    if (!has_end_) in_.fail_file("is cut short: no 'e' line, expected it at the end");
    if (out_.cuts.empty()) in_.fail_file("no 's' line, expected the value of the cut");
    if (!has_bottleneck_) in_.fail_file("no 'c bottleneck' line, expected yes or no");
    patches_.finish();
    if (!out_.bottleneck) return;
    for (size_t c = 0; c < out_.cuts.size(); ++c)
      if (std::none_of(out_.arcs.begin(), out_.arcs.end(),
                       [&](const CutArc& a) { return out_.crosses(a, c); }))
        in_.fail_file(
            fmt::format("a bottleneck without arcs, cut {}, expected pivot pairs", c + 1));
  }

  TextLines in_;
  CutFile out_;
  PatchReader patches_{in_, out_};
  bool has_bottleneck_ = false, has_end_ = false;
};

}  // namespace

std::string CutFile::name_if_several(size_t k) const {
  if (cameras.size() < 2) return "";
  const auto viewpoint = parse_viewpoint(cameras[k]);
  return viewpoint && !viewpoint->name.empty() ? viewpoint->name : fmt::format("camera {}", k + 1);
}

CutFile read_cut(const std::string& path) {
  const std::string text = read_file(path);
  CutFile file = CutReader(text, display_name(path)).read();
  file.hash = content_hash(text);
  return file;
}

std::string cut_text(const CutFile& file) {
  std::string out;
  const auto to = std::back_inserter(out);
  write_head(out, fmt::format("cut {}", format_version::cut), file);
  write_grid(out, file.grid);
  fmt::format_to(to, "c bottleneck {}\n", file.bottleneck ? "yes" : "no " + file.reason);
  for (const Bottleneck& cut : file.cuts) {
    fmt::format_to(to, "s {} {}", cut.flow, cut.conductance);
    out += file.cameras.size() > 1 ? fmt::format(" {}\n", cut.camera + 1) : "\n";
  }
  for (size_t i = 0; i < file.patches.size(); ++i) {
    const Patch& p = file.patches[i];
    fmt::format_to(to, "{} {} ", p.is_sky() ? 'k' : 'n', p.node);
    for (size_t c = 0; c < file.cuts.size(); ++c)
      out += file.side_of(i, c) == Side::sink ? '1' : '0';
    out += ' ';
    write_patch(out, p, "f");
  }
  write_light(out, file);
  for (const CutArc& a : file.arcs)
    fmt::format_to(to, "a {} {} {}\n", file.patches[a.from].node, file.patches[a.to].node,
                   a.capacity);
  fmt::format_to(to, "e {} {}\n", file.patches.size(), file.arcs.size());
  return out;
}

}  // namespace tdpt
