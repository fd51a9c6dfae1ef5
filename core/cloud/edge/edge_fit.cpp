#include "core/cloud/edge/edge_fit.h"

#include "core/cloud/coarse.h"
#include "core/cloud/edge/edge_fitter.h"

namespace seamwright {

namespace edge_fitting {

Expected<EdgeFit> EdgeFitter::run() {
    if (!options_.pairs_part.empty()) {
        SEAM_TRY(const auto pose, pose_of_pairs(options_.pairs_part, options_.pairs_base));
        options_.start = pose;
    }
    out_.fit.from_start = true;
    const SheetEnds found = sheet_ends(cloud_, options_.cancelled);
    if (stopped()) {
        refuse(FitStatus::cancelled, "cancelled");
        return out_;
    }
    radius_ = out_.radius_mm = found.radius_mm;
    noise_ = options_.noise_mm > 0 ? options_.noise_mm : found.noise_mm;
    if (found.ends.size() < kLeastEnds) {
        refuse(FitStatus::no_fit, "no sheet ends in the scan");
        return out_;
    }
    if (place_roughly(found) && place_exactly() && closed() && state()) look_elsewhere();
    if (out_.fit.status == FitStatus::ok || out_.fit.status == FitStatus::ambiguous ||
        out_.fit.status == FitStatus::under_determined)
        describe();
    return out_;
}

}  // namespace edge_fitting

Expected<EdgeFit> fit_edges(const Cloud& cloud, std::span<const EdgeCurve> edges, const Surface& surface,
                            const FitOptions& options) {
    SEAM_OK(check_fit_input(cloud, surface, options));
    if (!options.start && options.pairs_part.empty())
        return input_error("an edge alone is found from a start only", {},
                           "give where the part stands roughly, or three pairs of points");
    if (edges.empty()) return input_error("no edge is given");
    for (const EdgeCurve& e : edges)
        if (e.samples.size() < 2 || !(e.length_mm() > 0))
            return input_error("the edge has no length", Text(e.name));
    return edge_fitting::EdgeFitter(cloud, edges, surface, options).run();
}

}  // namespace seamwright
