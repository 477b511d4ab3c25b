// What a picture with a target error reports about it.
#pragma once
#include <map>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/tdpt-render/run/render.h"

namespace tdpt {

/// "target relMSE 0.01 reached: ..." or what stopped it.
std::string target_sentence(const TargetOutcome& target, uint64_t spp);
/// The object `target` of tdpt-render(1), STATISTICS.
nlohmann::ordered_json target_json(const TargetOutcome& target);
/// String attributes of the EXR header.
std::map<std::string, std::string> target_attributes(const TargetOutcome& target);

}  // namespace tdpt
