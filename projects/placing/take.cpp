#include "projects/placing/take.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "projects/gate/safety_gate.h"
#include "projects/measure/measure.h"
#include "projects/station/acquire.h"

namespace seamwright {
namespace {

const Region* region_called(const Project& project, const std::string& id) {
    for (const Region& r : project.regions)
        if (r.id == id) return &r;
    return nullptr;
}

bool frame_taken(const Project& project, const std::string& name) {
    return std::any_of(project.regions.begin(), project.regions.end(),
                       [&](const Region& r) { return same_frame(r.frame_name, name); }) ||
           std::any_of(project.panel_jobs.begin(), project.panel_jobs.end(),
                       [&](const PanelJob& j) { return same_frame(j.frame_name, name); });
}

// Letters, digits and underscores, which every controller takes.
std::string frame_of(const std::string& region) {
    std::string name = "BASE_";
    for (const char c : region) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return name;
}

Expected<Region> region_for(const Project& project, const std::string& edge, const TakeOptions& o) {
    if (!o.region_id.empty()) {
        if (!o.new_region.empty() || !o.frame.empty())
            return usage_error("a region that is there keeps its name and its frame", o.region_id,
                               "name a region, or the name and frame of a new one");
        const Region* known = region_called(project, o.region_id);
        if (!known) return usage_error(Text("there is no region \"{}\"", o.region_id), project.name);
        return *known;
    }
    Region region;
    region.id = o.new_region;
    if (region.id.empty())
        for (int n = 1; region.id.empty() || region_called(project, region.id); ++n)
            region.id = n == 1 ? fmt::format("drawing {}", edge) : fmt::format("drawing {} {}", edge, n);
    if (region_called(project, region.id))
        return usage_error(Text("there is a region \"{}\" already", region.id), project.name,
                           "give another name, or put the spots into it with --region");
    region.frame_name = o.frame.empty() ? frame_of(region.id) : o.frame;
    if (frame_taken(project, region.frame_name))
        return usage_error(Text("frame {} is written by another region or panel job", region.frame_name),
                           region.id, "name another one with --frame");
    region.base_from_frame = project.part.base_from_workobject;
    return region;
}

// The plane over the part, base frame, and what is lifted to it.
struct SafePlane {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
    double height_mm = 0;

    // The flange, moved along the normal until the sensor's origin is at the plane.
    Pose above(const Pose& base_from_flange, const Pose& flange_from_sensor) const {
        Pose lifted = base_from_flange;
        const double now = normal.dot((base_from_flange * flange_from_sensor).translation());
        lifted.pretranslate(std::max(0.0, height_mm - now) * normal);
        return lifted;
    }
};

SafePlane plane_over(const Project& project, const Drawing& drawing, const std::vector<const Spot*>& spots,
                     double safe_mm) {
    SafePlane plane;
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> places;
    for (const Spot* spot : spots)
        if (const Calibration* c = calibration_of(project, *spot)) {
            const Pose base_from_sensor = spot->base_from_flange * c->flange_from_sensor;
            sum += base_from_sensor.linear().col(2);
            places.push_back(base_from_sensor.translation());
        }
    // All round a part the axes cancel each other; then along the first one.
    if (sum.norm() < 0.2 * static_cast<double>(spots.size()) && !spots.empty())
        if (const Calibration* c = calibration_of(project, *spots.front()))
            sum = (spots.front()->base_from_flange * c->flange_from_sensor).linear().col(2);
    if (sum.norm() > 0) plane.normal = sum.normalized();
    double top = -std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3d& p : places) top = std::max(top, plane.normal.dot(p));
    for (const Eigen::Vector3d& v : drawing.mesh.vertices)
        top = std::max(top, plane.normal.dot(project.part.base_from_workobject * v));
    plane.height_mm = top + safe_mm;
    return plane;
}

// The robot comes to the first of `spots` from the spot that it measures before it.
void add_via(const Project& project, const Drawing& drawing, double safe_mm, const Spot* before,
             std::vector<Spot>& spots) {
    std::vector<const Spot*> all;
    for (const Spot& s : spots) all.push_back(&s);
    const SafePlane plane = plane_over(project, drawing, all, safe_mm);
    for (Spot& spot : spots) {
        const Calibration* c = calibration_of(project, spot);
        if (!c) continue;
        if (const Calibration* of_before = before ? calibration_of(project, *before) : nullptr)
            spot.via.push_back(plane.above(measuring_move(*before, of_before->flange_from_sensor).exit,
                                           of_before->flange_from_sensor));
        spot.via.push_back(
            plane.above(measuring_move(spot, c->flange_from_sensor).entry, c->flange_from_sensor));
        before = &spot;
    }
}

}  // namespace

Expected<TakenSpots> take_proposal(const Project& project, const Drawing& drawing,
                                   std::span<const std::byte> file, const Proposal& proposal,
                                   const TakeOptions& options) {
    if (proposal.spots.empty()) return input_error("no spot was proposed", drawing.source);
    if (!(options.safe_mm == 0 || (options.safe_mm >= 1 && options.safe_mm <= 2000)))
        return usage_error("the safe plane is not from 1 to 2000 mm over the part");
    const std::string edge = proposal.spots.front().spot.drawn ? proposal.spots.front().spot.drawn->edge : "";
    SEAM_TRY(auto region, region_for(project, edge, options));
    TakenSpots taken;
    taken.project = project;
    taken.region_id = region.id;
    taken.new_region = options.region_id.empty();
    std::vector<Spot> spots;
    for (const ProposedSpot& p : proposal.spots) {
        if (find_spot(project, p.spot.id))
            return input_error(Text("there is a spot \"{}\" already", p.spot.id), project.name,
                               "propose again");
        spots.push_back(p.spot);
        Spot& spot = spots.back();
        spot.reference_state = ReferenceState::from_drawing;
        if (!spot.drawn) spot.drawn.emplace();
        spot.drawn->name = drawing.source;
        spot.drawn->bytes = file.size();
        spot.drawn->crc32 =
            static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(file.data()), file.size()));
        taken.spot_ids.push_back(spot.id);
        region.spot_ids.push_back(spot.id);
    }
    const Spot* before = nullptr;
    for (const Spot& s : project.spots)
        if (s.enabled && s.robot_id == spots.front().robot_id) before = &s;
    if (options.safe_mm > 0) add_via(project, drawing, options.safe_mm, before, spots);
    for (Spot& s : spots) taken.project.spots.push_back(std::move(s));
    if (taken.new_region) {
        taken.project.regions.push_back(region);
    } else {
        for (Region& r : taken.project.regions)
            if (r.id == region.id) r = region;
    }
    return taken;
}

Expected<TakenSpots> without_unconfirmed(const Project& project, const std::string& region_id) {
    if (!region_id.empty() && !region_called(project, region_id))
        return usage_error(Text("there is no region \"{}\"", region_id), project.name);
    std::set<std::string> gone;
    for (const Region& r : project.regions)
        if (region_id.empty() || r.id == region_id)
            for (const std::string& id : unconfirmed_spots(project, r)) gone.insert(id);
    if (gone.empty())
        return input_error("there is no spot from the drawing that is not confirmed",
                           region_id.empty() ? Text(project.name) : Text("region {}", region_id));
    TakenSpots out;
    out.project = project;
    out.region_id = region_id;
    out.spot_ids.assign(gone.begin(), gone.end());
    std::erase_if(out.project.spots, [&](const Spot& s) { return gone.count(s.id) > 0; });
    std::erase_if(out.project.regions, [&](Region& r) {
        return std::erase_if(r.spot_ids, [&](const std::string& id) { return gone.count(id) > 0; }) > 0 &&
               r.spot_ids.empty();
    });
    return out;
}

}  // namespace seamwright
