// Implements Common: provenance, messages and the dependency file.
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <fmt/format.h>

#include "libcommon/base/error.h"
#include "libcommon/base/output_file.h"
#include "libcommon/base/process.h"
#include "libcommon/base/progress.h"
#include "libcommon/base/words.h"
#include "libcommon/cli/cli.h"
#include "libcommon/cli/outputs.h"
#include "tdpt_version.h"

namespace tdpt::cli {

Provenance Common::provenance(const std::vector<Input>& inputs) const {
  Provenance p;
  if (no_provenance) return p;
  for (const Input& input : inputs) p.inherit(input.provenance);
  p.made_by(tool, command);
  for (const Input& input : inputs) p.from(input.path, input.hash);
  return p;
}

std::string Common::canonical() const {
  std::string text = tool;
  for (const Given& one : given) {
    if (one.effect > Effect::samples || one.names_input) continue;
    if (one.values.empty()) text += " " + one.name;
    const char* before_value = one.name.starts_with("--set ") ? "=" : " ";
    for (const std::string& value : one.values)
      text += " " + one.name + before_value + value.substr(value.find_last_of('/') + 1);
  }
  return text;
}

void Common::give(const std::string& name, const std::vector<std::string>& values) {
  for (Given& one : given)
    if (one.name == name) one.values = values;
  command = canonical();
}

Fingerprint Common::fingerprint(const Fingerprint& facts, Effect up_to) const {
  Fingerprint all{{"program version", TDPT_VERSION}};
  all.insert(all.end(), facts.begin(), facts.end());
  for (const Given& one : given) {
    if (one.effect > up_to || one.names_input) continue;
    std::string value = one.values.empty() ? "given" : one.values[0];
    for (size_t i = 1; i < one.values.size(); ++i) value += "\n" + one.values[i];
    all.emplace_back(one.name, value);
  }
  return all;
}

namespace {

// Of several pictures at a time, as make -j has them, each line names its own: tdpt.mk says which.
std::string about(const std::string& tool) {
  const char* name = std::getenv("TDPT_ABOUT");
  return name && *name ? fmt::format("{}: {}", tool, name) : tool;
}

}  // namespace

void Common::note(const std::string& sentence) const {
  if (!quiet) say(fmt::format("{}: {}", about(tool), sentence));
}

void Common::explain_by(const std::function<Decisions()>& decisions) const {
  if (!explain) return;
  for (const Decision& d : decisions()) say(fmt::format("{}: {}", about(tool), sentence(d)));
}

void Common::warn(const std::string& sentence) const {
  say(fmt::format("{}: warning: {}", about(tool), sentence));
}

void Common::summary(const std::string& json_text) const {
  if (json) print(json_text + '\n');
}

void Common::print(const std::string& text) const {
  const bool to_errors = output == "-";
  std::FILE* const stream = to_errors ? stderr : stdout;
  if (std::fputs(text.c_str(), stream) == EOF || std::fflush(stream) != 0)
    throw OutputError(to_errors ? "(standard error)" : "(standard output)",
                      std::string("cannot be written: ") + std::strerror(errno));
}

void Common::also_read(const std::vector<std::string>& paths) const {
  check_outputs(outputs, paths);
  // A file made under another name will be renamed to the target.
  if (!target_.empty()) check_outputs({{"-MQ", target_}}, paths);
  if (!dependencies.empty()) std::for_each(paths.begin(), paths.end(), check_make_name);
  read_->insert(read_->end(), paths.begin(), paths.end());
}

std::string Common::dependency_rule() const {
  return make_rule(target_.empty() ? output : target_, *read_);
}

void Common::check_dependencies() const {
  if (dependencies.empty() && !target_.empty()) throw UsageError("-MQ goes with -MF");
  if (dependencies.empty()) return;
  if (output == "-" || (output.empty() && target_.empty()))
    throw UsageError("-MF tells what a file was made from: give -o FILE");
  check_make_name(target_.empty() ? output : target_);
}

std::string sentence(const Decision& d) {
  return fmt::format("{}: {}{}{}", d.what, d.chosen,
                     d.reason.empty() ? "" : ", because " + d.reason,
                     d.price.empty() ? "" : " (" + d.price + ")");
}

std::string price_of(double cpu_seconds) {
  if (cpu_seconds >= 10) return fmt::format("{:.0f} CPU s", cpu_seconds);
  return fmt::format("{} CPU s", number_words(cpu_seconds < 1e-4 ? 0.0 : cpu_seconds, 2));
}

std::string price_of(const Phases& phases, const std::vector<std::string>& names) {
  double sum = 0;
  for (const Phases::Phase& p : phases.all())
    if (std::find(names.begin(), names.end(), p.name) != names.end()) sum += p.cpu_seconds;
  return price_of(sum);
}

void deliver(const std::vector<Deliverable>& files, const Common& common) {
  Phases untold;
  deliver(files, common, untold);
}

void deliver(const std::vector<Deliverable>& files, const Common& common, Phases& phases) {
  std::vector<OutputFile> made;
  for (const Deliverable& file : files) {
    if (file.path.empty()) continue;
    made.push_back({file.path, file.make()});
    phases.done(&file == &files.front() ? "write" : "pictures");
  }
  if (!common.dependencies.empty()) made.push_back({common.dependencies, common.dependency_rule()});
  write_outputs(made);
  phases.done("write");
}

}  // namespace tdpt::cli
