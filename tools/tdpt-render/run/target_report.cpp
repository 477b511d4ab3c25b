#include "tools/tdpt-render/run/target_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/counted.h"
#include "libcommon/base/number_words.h"

namespace tdpt {
namespace {

using Stop = TargetOutcome::Stop;

// Indexed by Stop.
constexpr std::array kStops{"target", "spp", "time", "signal", "no light"};

const char* stop_of(const TargetOutcome& target) {
  return kStops[static_cast<size_t>(target.stop)];
}

// "about 0.0093 [0.0088, 0.0098]".
std::string estimate_of(const TargetOutcome& target) {
  if (!target.relmse) return "not known";
  return fmt::format("about {} [{}, {}]", number_words(*target.relmse, 2),
                     number_words(target.low, 2), number_words(target.high, 2));
}

}  // namespace

std::string target_sentence(const TargetOutcome& target, uint64_t spp) {
  const std::string aim = fmt::format("target relMSE {} ", number_words(target.error));
  if (target.dark) return aim + "reached: no light can come to the camera, the picture is black";
  const std::string got =
      fmt::format(": it is {} after {} per pixel{}", estimate_of(target), counted(spp, "sample"),
                  target.retried ? ", those of --set retry=1 among them" : "");
  if (target.reached()) return aim + "reached" + got;
  const std::string enough =
      target.fixed > 0 ? fmt::format("; {} would do", target.fixed) : std::string();
  switch (target.stop) {
    case Stop::spp:
      return aim + "not reached, stopped by --spp" + got + enough;
    case Stop::time:
      return aim + "not reached, stopped by --time" + got + enough;
    case Stop::signal:
      return aim + "not reached, stopped by a signal" + got + enough;
    case Stop::unlit:
      return aim + "not reached, too little light was met to tell how many samples it takes" + got;
    case Stop::fixed:
      break;
  }
  return aim + "missed" + got + (target.may_retry ? "; --set retry=1 renders on" : "");
}

nlohmann::ordered_json target_json(const TargetOutcome& target) {
  nlohmann::ordered_json j{{"error", target.error},
                           {"reached", target.reached()},
                           {"stopped_by", stop_of(target)},
                           {"relmse", nullptr},
                           {"interval", nullptr}};
  if (target.dark) j["relmse"] = 0;
  if (target.relmse) {
    j["relmse"] = *target.relmse;
    j["interval"] = {target.low, target.high};
  }
  j["fixed_spp"] = nullptr;
  if (target.fixed > 0) j["fixed_spp"] = target.fixed;
  j["retried"] = target.retried;
  j["pilot"] = {{"spp", target.pilot_samples}, {"cpu", target.pilot_cpu_seconds}};
  return j;
}

std::map<std::string, std::string> target_attributes(const TargetOutcome& target) {
  return {{"targetError", fmt::format("{:.6g}", target.error)},
          {"estimatedError", target.dark ? "0" : estimate_of(target)},
          {"stoppedBy", stop_of(target)}};
}

}  // namespace tdpt
