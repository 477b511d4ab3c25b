// Command lines: one table of options per tool, from which parsing, --help and provenance come.
// CLI11 stays behind this header.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/base/process.h"
#include "libcommon/base/provenance.h"
#include "libcommon/cli/outputs.h"

namespace tdpt::cli {

/// --quality: which of three settings of all knobs that trade speed for accuracy, along the Pareto
/// front of doc/efficiency.md.
enum class Quality { draft, normal, high };

/// Value of a knob at each quality, used if its own option is not given.
template <class T>
struct ByQuality {
  T draft, normal, high;
  T at(Quality quality) const {
    return quality == Quality::draft ? draft : quality == Quality::high ? high : normal;
  }
};

/// What an option changes, from most to least. A result is of the same picture as another if all
/// options of the first effect agree. Provenance names options of the first two.
enum class Effect {
  picture,  ///< what is computed: for a renderer, what each sample is; films of different ones are
            ///< never added
  samples,  ///< which samples there are of it, how many, by which device, and which channels and
            ///< filter the result gets
  stored,   ///< bytes of the file that its provenance does not account for by options: how it is
            ///< stored, by which instructions, and in how much time, it was made
  speed,    ///< how long it takes
  report    ///< what is printed, or written beside the result
};

/// What --explain prints: a decision of the run, with its reason and its price, in plain words
/// without a full stop; numbers with their units.
struct Decision {
  std::string what;    ///< what is decided on
  std::string chosen;  ///< what was decided
  std::string reason;  ///< completes "because ..."; may be empty
  std::string price;   ///< what it costs or saves: CPU seconds, rays, shares
};
using Decisions = std::vector<Decision>;

/// "what: chosen, because reason (price)"; without what is empty.
std::string sentence(const Decision& decision);

/// "0.31 CPU s": the phases of these names together; a phase that did not run counts 0.
std::string price_of(const Phases& phases, const std::vector<std::string>& names);
/// The same for a number.
std::string price_of(double cpu_seconds);

/// The sections of --help, in order [titles: options_impl.cpp].
enum class Part { files, effort, picture, camera, animation, light, lasting, telling, general };

/// An option present on the command line.
struct Given {
  std::string name;                 ///< the long name, "--spp"; of a setting "--set walks"
  std::vector<std::string> values;  ///< empty for a flag
  Effect effect = Effect::picture;
  Part part = Part::files;
  bool names_input = false;  ///< its values are input files
};

/// The options that work alike in all programs that have them.
struct Common {
  std::string output = "-";  ///< -o; "-": standard output
  uint64_t seed = 1;         ///< --seed
  int64_t threads = 0;       ///< --threads; 0: all cores. Already applied when run() is called.
  bool quiet = false;        ///< --quiet: no progress, no notes (warnings and errors stay)
  bool json = false;         ///< --json: summary on stdout, or on stderr when the result goes there
  bool explain = false;      ///< --explain: decisions on stderr, whatever --quiet says
  bool no_provenance = false;
  Quality quality = Quality::normal;  ///< normal if the tool has no such option

  std::vector<NamedFile> outputs;  ///< every file that the run writes, -o first
  /// Throws UsageError if one of the outputs is one of `paths`, inputs that become known only while
  /// another is read. They are also listed in the dependency file.
  void also_read(const std::vector<std::string>& paths) const;

  std::string dependencies;  ///< -MF; empty: not asked for
  /// Its contents: a Make rule with the files read so far.
  std::string dependency_rule() const;

  bool output_given = false;           ///< whether -o was given
  std::vector<Given> given;            ///< all that were given, in the order of the table
  std::vector<std::string> arguments;  ///< the command line as given, the program first

  std::string tool;     ///< name of the program
  std::string command;  ///< the tool, and options that are given, for the provenance
  /// Gives other values to an option that is given, or to none.
  void give(const std::string& name, const std::vector<std::string>& values);

  /// The one statement of what determines a result: the version of the program, `facts` (contents
  /// of files: "scene" with its hash, "portal"), and every option that is given and whose effect is
  /// at most `up_to`. What options name files is among the facts.
  Fingerprint fingerprint(const Fingerprint& facts, Effect up_to) const;

  /// Provenance for an output of this run: the lines of the inputs, then this stage. Empty with
  /// --no-provenance.
  struct Input {
    std::string path, hash;
    Provenance provenance;
  };
  Provenance provenance(const std::vector<Input>& inputs) const;

  /// A plain sentence on stderr, unless --quiet.
  void note(const std::string& sentence) const;
  /// With --explain prints the decisions, one line each on stderr; otherwise `decisions` is not
  /// called.
  void explain_by(const std::function<Decisions()>& decisions) const;
  /// "tool: warning: ..." on stderr, always.
  void warn(const std::string& sentence) const;
  /// Prints one JSON text (already dumped) where --json says; nothing without --json.
  void summary(const std::string& json_text) const;
  /// Prints what was asked for besides the result: on stdout, on stderr when the result goes there.
  /// Throws OutputError.
  void print(const std::string& text) const;

 private:
  friend class Options;
  /// The tool and the options that the provenance names, in the order of the table. Paths of inputs
  /// are left out: `from` lines name them.
  std::string canonical() const;
  void check_dependencies() const;
  std::string target_;  ///< -MQ; empty: the name given by -o
  /// Copies of these options, such as a quiet one, share the list.
  std::shared_ptr<std::vector<std::string>> read_ = std::make_shared<std::vector<std::string>>();
};

/// Kind of the result: text may go to a terminal, binary never does.
enum class Result { text, binary };

/// Common options that a program may have.
enum Uses : unsigned {
  kNone = 0,
  kSeed = 1,
  kThreads = 2,
  kQuiet = 4,     ///< it has notes or progress to suppress
  kProgress = 8,  ///< it shows progress
  kAll = 15
};

/// A program, and what --help says before its options.
struct Program {
  const char* tool;         ///< its name
  const char* summary;      ///< one sentence
  const char* output_help;  ///< what -o receives; null: there is no -o
  Result result = Result::text;
  // [kLibraries, kCommit]
  const char* libraries = "";  ///< what it is built with, one per line
  const char* commit = "";     ///< that it is built from
  unsigned uses = kAll;
};

class Options {
 public:
  explicit Options(const Program& program);
  ~Options();

  Common common;

  // bash completes what --help shows: lower-case words in a value's name, "cpu|gpu[:WHICH]", and
  // for input files the suffixes that `help` names, "(.glb, .gltf)".
  //
  // `flags` "--set walks" declares a setting, given as `--set walks=5000`: for what few users need;
  // --help lists these last. A setting whose name scripts rely on is an option as well:
  // "--samples,--set samples".

  /// Section of --help for the options declared from here on.
  void part(Part part);

  /// A positional argument: an input file.
  void argument(const std::string& name, std::string& target, const std::string& help,
                bool required = true);
  /// Positional arguments: input files. At least one must be given if `target` is empty.
  void arguments(const std::string& name, std::vector<std::string>& target,
                 const std::string& help);
  /// An input file named by an option; if there may be several, the option is repeated.
  void input(const std::string& flags, std::string& target, const std::string& value_name,
             const std::string& help);
  void inputs(const std::string& flags, std::vector<std::string>& target,
              const std::string& value_name, const std::string& help);
  /// An input file if `is_file` says so of the value; otherwise a setting that shapes the result.
  void input_or_setting(const std::string& flags, std::string& target,
                        const std::string& value_name, const std::string& help,
                        const std::function<bool(const std::string&)>& is_file);
  void option(const std::string& flags, std::string& target, const std::string& value_name,
              const std::string& help, Effect effect = Effect::picture);
  /// The same for one that may be repeated.
  void option(const std::string& flags, std::vector<std::string>& target,
              const std::string& value_name, const std::string& help,
              Effect effect = Effect::picture);
  /// A number within [lowest, highest]; anything else is a usage error.
  void option(const std::string& flags, int64_t& target, const std::string& value_name,
              const std::string& help, int64_t lowest, int64_t highest,
              Effect effect = Effect::picture);
  void option(const std::string& flags, double& target, const std::string& value_name,
              const std::string& help, double lowest, double highest,
              Effect effect = Effect::picture);
  /// The same for one that may be omitted.
  void option(const std::string& flags, std::optional<double>& target,
              const std::string& value_name, const std::string& help, double lowest, double highest,
              Effect effect = Effect::picture);
  /// A number that verdicts hang on, given as `--set NAME=VALUE`. There are many: --help lists them
  /// last, by name and default alone, and the man page explains them.
  void limit(const std::string& name, double& target, double lowest, double highest);
  /// --quality draft|normal|high. Knobs that depend on it are declared after it.
  void quality(Effect effect = Effect::picture);
  /// A knob that --quality sets unless the option is given. `help` must not mention defaults.
  void option(const std::string& flags, int64_t& target, const ByQuality<int64_t>& defaults,
              const std::string& value_name, const std::string& help, int64_t lowest,
              int64_t highest);
  /// One word out of `words`.
  void choice(const std::string& flags, std::string& target, const std::vector<std::string>& words,
              const std::string& help, Effect effect = Effect::picture);

  /// A file whose use depends on other options; `use` is called when all are parsed.
  enum class Use { read, written, neither };
  void file(const std::string& flags, std::string& target, const std::string& help,
            const std::function<Use()>& use);

  // Before run(), outputs are checked against inputs and against each other [outputs.h].
  /// A file written beside the result; its path, empty if not asked for.
  void side_output(const std::string& flags, std::string& target, const std::string& help);
  /// A flag that asks for a file beside the result. `path_of` derives its path from that of the
  /// result; it throws UsageError if there is none. `target`: that path, empty without the flag.
  void output_beside(const std::string& flags, std::string& target,
                     const std::function<std::string(const std::string&)>& path_of,
                     const std::string& help);
  /// `check` throws UsageError for an invalid path of the result.
  void result_name(const std::function<void(const std::string&)>& check);
  /// For a program whose result is binary: `is_text` says whether this run's result is text.
  void result_is_text(const std::function<bool()>& is_text);

  void flag(const std::string& flags, bool& target, const std::string& help,
            Effect effect = Effect::picture);

  /// A flag that, like --version, prints `text()` instead of running; positional arguments may be
  /// missing.
  void instead(const std::string& flags, const std::function<std::string()>& text,
               const std::string& help);

  /// Parses the command line, then calls `run`. Prints --help and --version. Turns every exception
  /// into one line on stderr and its exit code; nothing else in a tool does that.
  int run_main(int argc, char** argv, const std::function<int()>& run);

 private:
  // The options that every program has.
  void declare_general(const Program& program);
  void declare_what_else_is_printed(const Program& program);
  void declare_telling(const Program& program);

  struct Impl;
  std::unique_ptr<Impl> impl_;  // [options_impl.h]
};

/// main() of a program: `declare` makes its table of options, which fill in the arguments; `run`
/// does the work and returns the exit code.
template <class Arguments>
int run_program(int argc, char** argv, const Program& program,
                void (*declare)(Options&, Arguments&),
                int (*run)(const Arguments&, const Common&)) {
  Arguments arguments;
  Options options(program);
  declare(options, arguments);
  return options.run_main(argc, argv, [&] { return run(arguments, options.common); });
}

// How all programs end: every output file is made before the first is written, they are written
// together, and the summary says what the run cost.

/// A file to deliver. If `path` is empty, none was asked for and `make` is not called.
struct Deliverable {
  std::string path;
  std::function<std::string()> make;  ///< its bytes
};

/// Makes and writes `files`, the result first, and the run's dependency file [write_outputs,
/// base/output_file.h]. If one cannot be made or written, none of them is left behind.
void deliver(const std::vector<Deliverable>& files, const Common& common);
/// The same, timed as the phases "write" and, for files beside the result, "pictures".
void deliver(const std::vector<Deliverable>& files, const Common& common, Phases& phases);

/// Prints `summary`, a JSON object, where --json says, adding the cost of the run: "phases",
/// "cpu_seconds" and "peak_bytes".
template <class Json>
void report(const Common& common, Json summary, const Phases& phases) {
  summary["phases"] = phases;
  summary["cpu_seconds"] = cpu_seconds();
  summary["peak_bytes"] = peak_memory();
  common.summary(summary.dump());
}

// What a program was built from and with, for --version. Each executable defines its own, so that a
// new commit recompiles and relinks nothing else [cmake/libraries.cmake].

extern const char kLibraries[];  ///< one library and its version per line
extern const char kCommit[];     ///< of the git checkout, abbreviated; empty without one

}  // namespace tdpt::cli
