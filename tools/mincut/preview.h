// Pictures of a cut: its regions and pivot pairs, as in the paper's Fig. 4. A region lies between
// the cuts of one camera.
#pragma once
#include <string>
#include <vector>

#include "libcommon/draw/drawing.h"
#include "libcommon/formats/cut.h"
#include "libcommon/scene/scene.h"
#include "tools/mincut/cut_of.h"

namespace tdpt {

/// What of the cuts concerns one camera.
CutFile cuts_for(const FoundCuts& found, size_t camera);

/// At most `most` of the cut's arcs, as indices, drawn with probability in proportion to capacity
/// (systematic sampling), so that both of two openings show. Ascending, no arc twice.
std::vector<size_t> arcs_to_draw(const CutFile& cut, size_t most);

/// Camera view and plan, one colour per region, pivot pairs as lines, darker for more capacity.
/// Throws InputError for `cut_name` if the cut was made from another scene.
draw::Drawing cut_preview(const Scene& scene, const Camera& camera, const CutFile& cut,
                          const std::string& cut_name);
/// glTF: a square for every patch in the colour of its region, pivot pairs as lines.
std::string cut_debug_glb(const CutFile& cut);

}  // namespace tdpt
