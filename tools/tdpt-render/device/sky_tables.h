// Part of make_light_tables(): the sky and its windows.
#pragma once
#include "tools/tdpt-render/device/light_tables.h"

namespace tdpt {

/// Needs a sky.
void add_sky(const Vista& vista, double radiance_unit, LightTables& tables);
/// Adds the part of the sky that each window shows, if there are windows.
void add_windows(const WindowSky& windows, double radiance_unit, LightTables& tables);

}  // namespace tdpt
