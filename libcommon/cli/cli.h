// Command lines: one table of options per tool, from which parsing, --help and provenance come.
// CLI11 stays behind this header.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libcommon/base/provenance.h"
#include "libcommon/cli/decision.h"
#include "libcommon/cli/outputs.h"

namespace tdpt::cli {

/// --quality: which of three settings of all knobs that trade speed for accuracy, along the front
/// that doc/tradeoff.md shows.
enum class Quality { draft, normal, high };

/// What a knob is at each of them where its own option is not given.
template <class T>
struct ByQuality {
  T draft, normal, high;
  T at(Quality quality) const {
    return quality == Quality::draft ? draft : quality == Quality::high ? high : normal;
  }
};

/// An option that the command line has.
struct Given {
  std::string name;                 ///< the long one, "--spp"; of a setting "--set walks"
  std::vector<std::string> values;  ///< empty of a flag
};

/// The options that are alike in all programs that have them.
struct Common {
  std::string output = "-";  ///< -o; "-": standard output
  uint64_t seed = 1;         ///< --seed
  int64_t threads = 0;       ///< --threads; 0: all cores. Already applied when run() is called.
  bool quiet = false;        ///< --quiet: no progress, no notes (warnings and errors stay)
  bool json = false;         ///< --json: summary on stdout, or on stderr when the result goes there
  bool explain = false;      ///< --explain: decisions on stderr, whatever --quiet says
  bool no_provenance = false;
  Quality quality = Quality::normal;  ///< where the tool has such an option

  std::vector<NamedFile> outputs;  ///< all that the run writes, -o first
  /// Throws UsageError when one of the outputs is one of `paths`: inputs that show only when
  /// another is read. All that is told here stands in the dependency file.
  void also_read(const std::vector<std::string>& paths) const;

  std::string dependencies;  ///< -MF; empty: not asked for
  /// What stands in it: a rule for Make, of the files read so far.
  std::string dependency_rule() const;

  bool output_given = false;           ///< -o was
  std::vector<Given> given;            ///< all options that were, in the order of the table
  std::vector<std::string> arguments;  ///< the command line as given, the program first

  std::string tool;     ///< name of the program
  std::string command;  ///< canonical command: the tool and the options that shape the result

  /// Lines for an output of this run: those of the inputs, then this stage. Empty with
  /// --no-provenance.
  struct Input {
    std::string path, hash;
    Provenance provenance;
  };
  Provenance provenance(const std::vector<Input>& inputs) const;

  /// A plain sentence on stderr, unless --quiet.
  void note(const std::string& sentence) const;
  /// With --explain the decisions, a line each on stderr; else they are not asked for.
  void explain_by(const std::function<Decisions()>& decisions) const;
  /// "tool: warning: ..." on stderr, always.
  void warn(const std::string& sentence) const;
  /// The same of an input that other programs of a chain read, too: what one of them has told of
  /// it, the others leave out [told.h].
  void note_of(const std::string& file, const std::string& sentence) const;
  void warn_of(const std::string& file, const std::string& sentence) const;
  /// One JSON text (already dumped) where --json says; nothing without --json.
  void summary(const std::string& json_text) const;

 private:
  friend class Options;
  void check_dependencies() const;
  std::string target_;  ///< -MQ; empty: what -o names
  mutable std::vector<std::string> read_;
};

/// Whether an option shapes the bytes of the result (then it stands in the provenance) or not
/// (--threads, --quiet, side outputs).
enum class Shapes { result, nothing };

/// What the result is made of: a terminal shows text, and is never sent bytes.
enum class Result { text, binary };

/// Options that a program has if it makes use of them.
enum Uses : unsigned {
  kNone = 0,
  kSeed = 1,
  kThreads = 2,
  kQuiet = 4,     ///< it has notes or progress to leave out
  kProgress = 8,  ///< it shows any
  kAll = 15
};

/// The parts of --help, in its order [help.cpp has their titles].
enum class Part { files, effort, picture, camera, light, lasting, telling, general };

/// A program, and what --help says of it before its options.
struct Program {
  const char* tool;         ///< its name
  const char* summary;      ///< one sentence
  const char* output_help;  ///< what -o receives; null: the program has no -o
  Result result = Result::text;
  // [built_with.h]
  const char* libraries = "";  ///< what it is built with, a line each
  const char* commit = "";     ///< that it is built from
  unsigned uses = kAll;
};

class Options {
 public:
  explicit Options(const Program& program);
  ~Options();

  Common common;

  // What --help shows is also what shells complete [completion.h]: words in small letters of a
  // value's name, "cpu|gpu[:WHICH]", and of files that are read the suffixes that `help` names,
  // "(.glb, .gltf)".
  //
  // `flags` "--set walks" declares a setting, given as `--set walks=5000`: what few need, and
  // --help lists last. One whose name scripts rely on is an option as well: "--samples,--set
  // samples".

  /// Where --help lists the options that are declared from here on.
  void part(Part part);

  /// A positional argument: a file that is read.
  void argument(const std::string& name, std::string& target, const std::string& help,
                bool required = true);
  /// Positional arguments: files that are read. One at least must be given where `target` is empty.
  void arguments(const std::string& name, std::vector<std::string>& target,
                 const std::string& help);
  /// A file that is read, named by an option; of several, each by the option again.
  void input(const std::string& flags, std::string& target, const std::string& value_name,
             const std::string& help);
  void inputs(const std::string& flags, std::vector<std::string>& target,
              const std::string& value_name, const std::string& help);
  /// A file that is read where `is_file` says so of the value; otherwise a setting that shapes the
  /// result.
  void input_or_setting(const std::string& flags, std::string& target,
                        const std::string& value_name, const std::string& help,
                        const std::function<bool(const std::string&)>& is_file);
  void option(const std::string& flags, std::string& target, const std::string& value_name,
              const std::string& help, Shapes shapes = Shapes::result);
  /// A number within [lowest, highest]; anything else is a usage error.
  void option(const std::string& flags, int64_t& target, const std::string& value_name,
              const std::string& help, int64_t lowest, int64_t highest,
              Shapes shapes = Shapes::result);
  void option(const std::string& flags, double& target, const std::string& value_name,
              const std::string& help, double lowest, double highest,
              Shapes shapes = Shapes::result);
  /// The same of one that may be left out.
  void option(const std::string& flags, std::optional<double>& target,
              const std::string& value_name, const std::string& help, double lowest, double highest,
              Shapes shapes = Shapes::result);
  /// --quality draft|normal|high. The knobs that follow it are declared after it.
  void quality();
  /// A knob that --quality sets where the option is not given. `help` says nothing of defaults.
  void option(const std::string& flags, int64_t& target, const ByQuality<int64_t>& defaults,
              const std::string& value_name, const std::string& help, int64_t lowest,
              int64_t highest);
  /// One word out of `words`.
  void choice(const std::string& flags, std::string& target, const std::vector<std::string>& words,
              const std::string& help, Shapes shapes = Shapes::result);

  /// A file whose use depends on other options; `use` is asked when all are parsed.
  enum class Use { read, written, neither };
  void file(const std::string& flags, std::string& target, const std::string& help,
            const std::function<Use()>& use);

  // Before run(), outputs are held against inputs and against each other [outputs.h].
  /// A file written beside the result; its path, empty when not asked for.
  void side_output(const std::string& flags, std::string& target, const std::string& help);
  /// A flag: a file beside the result whose path `path_of` makes of that of the result; it throws
  /// UsageError where there is none. `target`: that path, empty without the flag.
  void output_beside(const std::string& flags, std::string& target,
                     const std::function<std::string(const std::string&)>& path_of,
                     const std::string& help);
  /// `check` throws UsageError for a path that the result cannot have.
  void result_name(const std::function<void(const std::string&)>& check);
  /// Of a program whose result is binary: `is_text` says whether it is not, this time.
  void result_is_text(const std::function<bool()>& is_text);

  void flag(const std::string& flags, bool& target, const std::string& help,
            Shapes shapes = Shapes::result);

  /// A flag that, like --version, prints `text()` instead of running; the arguments may be missing.
  void instead(const std::string& flags, const std::function<std::string()>& text,
               const std::string& help);

  /// Parses the command line, then calls `run`. Prints --help and --version. Turns every exception
  /// into one line on stderr and its exit code. The only place in a tool that does.
  int run_main(int argc, char** argv, const std::function<int()>& run);

 private:
  // What programs have without declaring it.
  void declare_general(const Program& program);
  void declare_what_else_is_printed(const Program& program);
  void declare_telling(const Program& program);

  struct Impl;
  std::unique_ptr<Impl> impl_;  // [options_impl.h]
};

/// main() of a program: `declare` makes its table of options, which fill in the arguments, `run`
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

}  // namespace tdpt::cli
