// One command line for the pictures of several cameras: a run for each, whose stages are the same.
#pragma once
#include <vector>

#include "tools/tdpt/request.h"

namespace tdpt {

/// What one picture is made by, as if its camera and its files were those on the command line.
struct View {
  Arguments arguments;
  cli::Common common;
};

/// One per camera that --camera names, else one. In the names of files % is the camera's name. The
/// scene is read only if --camera may select several. Throws UsageError for names of files without
/// %, or that two cameras share.
std::vector<View> views_of(const Arguments& a, const cli::Common& common);

}  // namespace tdpt
