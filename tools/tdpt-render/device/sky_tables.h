// Part of make_light_tables(): the sky and its windows.
#pragma once
#include "tools/tdpt-render/device/light_tables.h"

namespace tdpt {

/// There must be a sky.
void add_sky(const World& world, double radiance_unit, LightTables& tables);
/// What portals show of it, if they do.
void add_windows(const World& world, double radiance_unit, LightTables& tables);

}  // namespace tdpt
