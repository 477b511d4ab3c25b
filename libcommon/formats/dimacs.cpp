#include "libcommon/formats/dimacs.h"

#include <algorithm>
#include <optional>

#include "libcommon/base/file.h"
#include "libcommon/formats/patch_lines.h"

namespace tdpt {
namespace {
using namespace patch_lines;

// Nodes that no line mentions are legal, but cost a solver memory: this many are accepted, plus one
// per byte of the file.
constexpr int64_t kNodesForNothing = 1 << 20;

class DimacsReader {
 public:
  DimacsReader(std::string_view text, const std::string& file)
      : in_(text, file), most_nodes_(kNodesForNothing + static_cast<int64_t>(text.size())) {}

  DimacsFile read() {
    in_.expect_text("a DIMACS maximum-flow problem such as ffgraph writes");
    while (in_.next()) {
      const std::string_view key = in_.word();
      if (key == "c")
        comment();
      else if (key == "p")
        problem();
      else if (key == "n")
        terminal();
      else if (key == "a")
        arc();
      else
        in_.fail(TextLines::found(key) + " at the start of the line, expected one of c, p, n, a");
    }
    finish();
    return std::move(out_);
  }

 private:
  FlowNetwork& net() { return out_.network; }

  void comment() {
    if (!out_.has_patches) {
      if (in_.word() == "tdpt") version();
      return;
    }
    const std::string_view word = patches_.comment();
    if (word == "sink") {
      out_.more_sinks.push_back(
          static_cast<uint32_t>(in_.integer("sink of a camera", 1, INT32_MAX)) - 1);
      in_.end();
    } else if (word == "scale") {
      out_.scale = in_.real("scale");
      if (!(out_.scale > 0)) in_.fail("a scale of 0 or less, expected one above 0");
      in_.end();
    } else if (word == "patch" || word == "sky") {
      patches_.geometry(patches_.node("node of a patch"), word == "sky");
    } else if (word == "walks") {
      const uint32_t i = patches_.patch_above("node of walks");
      out_.walks.resize(std::max<size_t>(out_.walks.size(), i + 1));
      out_.walks[i] = read_walks();
    } else if (word == "faces") {
      patches_.faces();
    }
  }

  size_t cameras() const { return out_.number_of_cameras(); }

  PatchWalks read_walks() {
    const auto number = [&] {
      return read_amount(in_, "number of walks", "a negative number of walks");
    };
    PatchWalks walks;
    walks.begun = number();
    walks.light = number();
    for (size_t k = 0; k < cameras(); ++k) walks.camera.push_back(number());
    in_.end();
    return walks;
  }

  // "max VERSION"; any other comment may come from another program.
  void version() {
    if (in_.word() != "max" || in_.rest().find_first_of("0123456789") != 0) return;
    in_.expect_version(format_version::max);
    in_.expect_whole_lines();
    out_.has_patches = true;
  }

  void problem() {
    if (net().nodes) in_.fail("a second 'p' line, expected one");
    const std::string_view kind = in_.word();
    if (kind != "max") in_.fail(TextLines::found(kind) + " as problem, expected max");
    net().nodes = static_cast<uint32_t>(in_.integer("number of nodes", 2, INT32_MAX));
    if (net().nodes > most_nodes_)
      in_.fail(fmt::format("{} nodes in a file of {} bytes, expected at most {}", net().nodes,
                           most_nodes_ - kNodesForNothing, most_nodes_));
    announced_arcs_ = in_.integer("number of arcs", 0, INT32_MAX);
    in_.end();
  }

  uint32_t node(const char* what) {
    if (!net().nodes)
      in_.fail("a line that needs the numbers of a 'p max' line, expected it above");
    return static_cast<uint32_t>(in_.integer(what, 1, net().nodes)) - 1;
  }

  void terminal() {
    const uint32_t v = node("node");
    const std::string_view which = in_.word();
    if (which != "s" && which != "t")
      in_.fail(TextLines::found(which) + " as terminal, expected s or t");
    std::optional<uint32_t>& terminal = which == "s" ? source_ : sink_;
    if (terminal)
      in_.fail(which == "s" ? "a second source, expected one" : "a second sink, expected one");
    terminal = v;
    if (source_ == sink_) in_.fail("the same node as source and sink, expected two nodes");
    in_.end();
  }

  void arc() {
    FlowArc a{};
    a.from = node("tail of an arc");
    a.to = node("head of an arc");
    a.capacity = in_.integer("capacity", 0, INT64_MAX);
    in_.end();
    if (a.capacity >= kLargestCapacitySum - capacity_sum_)
      in_.fail(
          fmt::format("capacities add up beyond {}, expected a smaller sum", kLargestCapacitySum));
    capacity_sum_ += a.capacity;
    if (static_cast<int64_t>(net().arcs.size()) == announced_arcs_)
      in_.fail(fmt::format("one arc more than the {} of the 'p' line", announced_arcs_));
    net().arcs.push_back(a);
  }

  void finish() {
    if (!net().nodes) in_.fail_file("no 'p max' line, expected a DIMACS maximum-flow problem");
    if (!source_) in_.fail_file("no source, expected a line 'n NODE s'");
    if (!sink_) in_.fail_file("no sink, expected a line 'n NODE t'");
    net().source = *source_;
    net().sink = *sink_;
    if (static_cast<int64_t>(net().arcs.size()) != announced_arcs_)
      in_.fail_file(fmt::format("{} arcs, expected the {} of the 'p' line", net().arcs.size(),
                                announced_arcs_));
    if (!out_.has_patches) return;
    check_sinks();
    if (!out_.walks.empty()) out_.walks.resize(out_.patches.size());
    for (PatchWalks& walks : out_.walks) walks.camera.resize(cameras(), 0);
    patches_.finish();
    // Capacities to be cut again must not exceed the samples.
    double samples = 0;
    for (const Patch& p : out_.patches) samples += p.samples;
    if (!(samples * out_.scale < static_cast<double>(kLargestCapacitySum)))
      in_.fail_file(
          fmt::format("samples times the scale add up to {:.3g}, expected less than {:.3g}",
                      samples * out_.scale, static_cast<double>(kLargestCapacitySum)));
    for (const Patch& p : out_.patches)
      if (p.node > net().nodes - out_.more_sinks.size() || p.node - 1 == *source_ ||
          p.node - 1 == *sink_)
        in_.fail_file(fmt::format("patch {} is no inner node of the network", p.node));
    const size_t terminals = 2 + out_.more_sinks.size();
    if (out_.patches.size() + terminals != net().nodes)
      in_.fail_file(fmt::format("{} patches, expected one for each of the {} inner nodes",
                                out_.patches.size(), net().nodes - terminals));
  }

  // The sinks of further cameras are the last nodes, in order.
  void check_sinks() {
    const std::vector<uint32_t>& sinks = out_.more_sinks;
    if (1 + sinks.size() != cameras())
      in_.fail_file(fmt::format("{} cameras and {} more sinks, expected one for each but the first",
                                cameras(), sinks.size()));
    if (net().nodes < 2 + sinks.size())
      in_.fail_file(fmt::format("{} nodes for {} cameras, expected more", net().nodes, cameras()));
    const auto first = static_cast<uint32_t>(net().nodes - sinks.size());
    for (uint32_t k = 0; k < sinks.size(); ++k)
      if (sinks[k] != first + k)
        in_.fail_file(fmt::format("node {} as sink of camera {}, expected {}: they are the last",
                                  sinks[k] + 1, k + 2, first + k + 1));
    for (const FlowArc& a : net().arcs)
      if (a.from >= first)
        in_.fail_file(fmt::format("an arc from node {}, a sink, expected none", a.from + 1));
  }

  TextLines in_;
  DimacsFile out_;
  PatchReader patches_{in_, out_};
  std::optional<uint32_t> source_, sink_;
  const int64_t most_nodes_;
  int64_t announced_arcs_ = 0, capacity_sum_ = 0;
};

}  // namespace

DimacsFile read_dimacs(const std::string& path) {
  const std::string text = read_file(path);
  DimacsFile file = DimacsReader(text, display_name(path)).read();
  file.hash = content_hash(text);
  return file;
}

PatchNetwork network_between(const DimacsFile& file, size_t camera) {
  const FlowNetwork& all = file.network;
  PatchNetwork p;
  p.scale = file.scale;
  p.network = {static_cast<uint32_t>(all.nodes - file.more_sinks.size()), all.source, all.sink, {}};
  const size_t nodes = p.network.nodes;
  const uint32_t own = camera == 0 ? all.sink : file.more_sinks[camera - 1];
  for (FlowArc arc : all.arcs) {
    const bool to_sink = arc.to == all.sink || arc.to >= nodes;
    if (to_sink && arc.to != own) continue;
    if (to_sink) arc.to = all.sink;
    p.network.arcs.push_back(arc);
  }
  p.samples.assign(nodes, 0);
  if (!file.walks.empty()) p.begun = p.lit = p.viewed = p.samples;
  const bool lit = std::any_of(file.light.begin(), file.light.end(),
                               [&](const PatchLight& l) { return l.importance[camera] > 0; });
  if (lit) p.brightness = p.importance = p.samples;
  for (size_t i = 0; i < file.patches.size(); ++i) {
    const size_t node = file.patches[i].node - 1;
    p.samples[node] = file.patches[i].samples;
    if (file.patches[i].is_sky()) p.sky.resize(nodes, 0), p.sky[node] = 1;
    if (lit) {
      p.brightness[node] = file.light[i].brightness;
      p.importance[node] = file.light[i].importance[camera];
    }
    if (file.walks.empty()) continue;
    p.begun[node] = file.walks[i].begun;
    p.lit[node] = file.walks[i].light;
    p.viewed[node] = file.walks[i].camera[camera];
  }
  return p;
}

std::string dimacs_text(const DimacsFile& file) {
  std::string out;
  const auto to = std::back_inserter(out);
  if (file.has_patches) {
    write_head(out, fmt::format("max {}", format_version::max), file);
    for (const uint32_t sink : file.more_sinks) fmt::format_to(to, "c sink {}\n", sink + 1);
    fmt::format_to(to, "c scale {}\n", file.scale);
    write_grid(out, file.grid);
    for (const Patch& p : file.patches) {
      fmt::format_to(to, "c {} {} ", p.is_sky() ? "sky" : "patch", p.node);
      write_patch(out, p, "c faces");
    }
    for (size_t i = 0; i < file.walks.size(); ++i) {
      const PatchWalks& w = file.walks[i];
      fmt::format_to(to, "c walks {} {} {}", file.patches[i].node, w.begun, w.light);
      for (const double hits : w.camera) fmt::format_to(to, " {}", hits);
      out += '\n';
    }
    write_light(out, file);
  }
  const FlowNetwork& net = file.network;
  fmt::format_to(to, "p max {} {}\nn {} s\nn {} t\n", net.nodes, net.arcs.size(), net.source + 1,
                 net.sink + 1);
  for (const FlowArc& a : net.arcs) {
    out += 'a';
    for (const int64_t number : {a.from + int64_t{1}, a.to + int64_t{1}, a.capacity}) {
      const fmt::format_int digits(number);
      out += ' ';
      out.append(digits.data(), digits.size());
    }
    out += '\n';
  }
  return out;
}

}  // namespace tdpt
