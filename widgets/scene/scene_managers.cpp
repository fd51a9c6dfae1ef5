#include "widgets/scene/scene_managers.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>

#include "widgets/style.h"

namespace seamwright {
namespace {

QColor faded(QColor colour, int alpha) {
    colour.setAlpha(alpha);
    return colour;
}

}  // namespace

ScenePainter::ScenePainter() : data_(vtkSmartPointer<vtkPolyData>::New()) {
    data_->SetPoints(vtkSmartPointer<vtkPoints>::New());
    data_->SetLines(vtkSmartPointer<vtkCellArray>::New());
    data_->SetPolys(vtkSmartPointer<vtkCellArray>::New());
}

vtkIdType ScenePainter::point(const Eigen::Vector3d& p) {
    return data_->GetPoints()->InsertNextPoint(p.data());
}

void ScenePainter::colour(std::vector<unsigned char>& colours, const QColor& colour) {
    for (const int part : {colour.red(), colour.green(), colour.blue(), colour.alpha()})
        colours.push_back(static_cast<unsigned char>(part));
}

void ScenePainter::line(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const QColor& with) {
    const vtkIdType ends[2] = {point(a), point(b)};
    data_->GetLines()->InsertNextCell(2, ends);
    colour(line_colours_, with);
}

void ScenePainter::triangle(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                            const QColor& with) {
    const vtkIdType corners[3] = {point(a), point(b), point(c)};
    data_->GetPolys()->InsertNextCell(3, corners);
    colour(face_colours_, with);
}

void ScenePainter::arrow(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double thickness,
                         const QColor& with) {
    const Eigen::Vector3d along = to - from;
    const double length = along.norm();
    if (!(length > 1e-6)) return;
    const Eigen::Vector3d u = along / length;
    const Eigen::Vector3d side = u.unitOrthogonal(), other = u.cross(side);
    const double head = std::min(0.45 * length, 3.2 * thickness);
    const Eigen::Vector3d neck = to - head * u;
    constexpr int kSides = 8;
    for (int i = 0; i < kSides; ++i) {
        const auto around = [&](int k) {
            const double angle = 2 * kPi * k / kSides;
            return Eigen::Vector3d(std::cos(angle) * side + std::sin(angle) * other);
        };
        const Eigen::Vector3d a = around(i), b = around(i + 1);
        const double r = thickness / 2, wide = 1.3 * thickness;
        triangle(from + r * a, from + r * b, neck + r * b, with);
        triangle(from + r * a, neck + r * b, neck + r * a, with);
        triangle(neck + wide * a, neck + wide * b, to, with);
        triangle(neck + wide * b, neck + wide * a, neck, with);
    }
}

void ScenePainter::tube(const Eigen::Vector3d& a, double a_radius, const Eigen::Vector3d& b, double b_radius,
                        const QColor& with) {
    const Eigen::Vector3d along = b - a;
    if (!(along.norm() > 1e-9) || !std::isfinite(a_radius) || !std::isfinite(b_radius)) return;
    const Eigen::Vector3d u = along.normalized(), side = u.unitOrthogonal(), other = u.cross(side);
    constexpr int kSides = 8;
    for (int i = 0; i < kSides; ++i) {
        const auto around = [&](int k) {
            const double angle = 2 * kPi * k / kSides;
            return Eigen::Vector3d(std::cos(angle) * side + std::sin(angle) * other);
        };
        const Eigen::Vector3d p = around(i), q = around(i + 1);
        triangle(a + a_radius * p, a + a_radius * q, b + b_radius * q, with);
        triangle(a + a_radius * p, b + b_radius * q, b + b_radius * p, with);
    }
}

void ScenePainter::axes(const Pose& pose, double length, double thickness, int alpha) {
    const QRgb colours[3] = {style::kVermilion, style::kBluishGreen, style::kBlue};  // x, y, z
    for (int i = 0; i < 3; ++i)
        arrow(pose.translation(), pose * Eigen::Vector3d(length * Eigen::Vector3d::Unit(i)), thickness,
              faded(QColor::fromRgb(colours[i]), alpha));
}

void ScenePainter::ball(const Eigen::Vector3d& centre, double radius, const QColor& with) {
    constexpr int kRings = 6, kSides = 10;
    const auto at = [&](int ring, int side) {
        const double polar = kPi * ring / kRings, around = 2 * kPi * side / kSides;
        return Eigen::Vector3d(centre + radius * Eigen::Vector3d(std::sin(polar) * std::cos(around),
                                                                 std::sin(polar) * std::sin(around),
                                                                 std::cos(polar)));
    };
    for (int ring = 0; ring < kRings; ++ring)
        for (int side = 0; side < kSides; ++side) {
            triangle(at(ring, side), at(ring + 1, side), at(ring + 1, side + 1), with);
            triangle(at(ring, side), at(ring + 1, side + 1), at(ring, side + 1), with);
        }
}

void ScenePainter::box(const Pose& pose, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
                       const QColor& with) {
    const auto corner = [&](int i) {
        return Eigen::Vector3d(pose * Eigen::Vector3d(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(),
                                                      i & 4 ? high.z() : low.z()));
    };
    constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                  {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    for (const auto& f : kFaces) {
        triangle(corner(f[0]), corner(f[1]), corner(f[2]), with);
        triangle(corner(f[0]), corner(f[2]), corner(f[3]), with);
    }
}

vtkSmartPointer<vtkPolyData> ScenePainter::take() {
    // VTK numbers the cells of a mesh lines first.
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(4);
    colours->SetName("colours");
    line_colours_.insert(line_colours_.end(), face_colours_.begin(), face_colours_.end());
    for (std::size_t i = 0; i + 3 < line_colours_.size(); i += 4)
        colours->InsertNextTypedTuple(&line_colours_[i]);
    data_->GetCellData()->SetScalars(colours);
    return data_;
}

LayerManager::LayerManager(vtkRenderer& renderer, bool lit, double line_width)
    : actor_(vtkSmartPointer<vtkActor>::New()) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(vtkSmartPointer<vtkPolyData>::New());
    mapper->SetScalarModeToUseCellData();
    mapper->SetColorModeToDirectScalars();
    actor_->SetMapper(mapper);
    actor_->GetProperty()->SetLighting(lit);
    actor_->GetProperty()->SetLineWidth(static_cast<float>(line_width));
    renderer.AddActor(actor_);
}

void LayerManager::set(const vtkSmartPointer<vtkPolyData>& data) {
    static_cast<vtkPolyDataMapper*>(actor_->GetMapper())->SetInputData(data);
    bool translucent = false;
    auto* colours = vtkUnsignedCharArray::SafeDownCast(data->GetCellData()->GetScalars());
    for (vtkIdType i = 0; colours && i < colours->GetNumberOfTuples() && !translucent; ++i)
        translucent = colours->GetTypedComponent(i, 3) < 255;
    if (translucent)
        actor_->ForceTranslucentOn();
    else
        actor_->ForceTranslucentOff();
    actor_->SetVisibility(shown_ && data->GetNumberOfCells() > 0);
}

void LayerManager::set_shown(bool shown) {
    shown_ = shown;
    actor_->SetVisibility(
        shown && static_cast<vtkPolyDataMapper*>(actor_->GetMapper())->GetInput()->GetNumberOfCells() > 0);
}

namespace {

Eigen::Vector3d reference_of(const SceneSpot& spot) {
    return spot.workobject_from_sensor * spot.reference_mm;
}

// The middle of a region's spots, lifted towards the sensors so that the part does not hide it.
std::optional<Eigen::Vector3d> lifted_centre(const SceneRegion& region, const std::vector<SceneSpot>& spots) {
    constexpr double kLift_mm = 80;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero(), up = Eigen::Vector3d::Zero();
    int count = 0;
    for (const SceneSpot& spot : spots)
        if (std::find(region.spot_ids.begin(), region.spot_ids.end(), spot.id) != region.spot_ids.end()) {
            centre += reference_of(spot);
            up += spot.workobject_from_sensor.linear().col(2);
            ++count;
        }
    if (count == 0) return std::nullopt;
    centre /= count;
    if (up.norm() > 1e-6) centre += kLift_mm * up.normalized();
    return centre;
}

}  // namespace

vtkSmartPointer<vtkPolyData> draw_spots(const std::vector<SceneSpot>& spots, const std::string& selected,
                                        const QPalette& palette) {
    ScenePainter painter;
    for (const SceneSpot& spot : spots) {
        const bool chosen = spot.id == selected;
        const QColor colour = chosen         ? style::selection(palette)
                              : spot.enabled ? style::attention(palette)
                                             : style::axis(palette);
        painter.ball(reference_of(spot), chosen ? 11 : 7, colour);
        if (spot.enabled) painter.axes(spot.workobject_from_sensor, chosen ? 60 : 36, chosen ? 4 : 2.5);
    }
    return painter.take();
}

vtkSmartPointer<vtkPolyData> draw_sensors(const std::vector<SceneSpot>& spots, const std::string& selected,
                                          const QPalette& palette) {
    ScenePainter painter;
    for (const SceneSpot& spot : spots) {
        if (!spot.enabled) continue;
        const bool chosen = spot.id == selected;
        const Pose& pose = spot.workobject_from_sensor;
        const double half = spot.field_mm / 2;
        const Eigen::Vector3d source = pose * Eigen::Vector3d(0, 0, spot.stand_off_mm);
        const Eigen::Vector3d left = pose * Eigen::Vector3d(-half, 0, 0),
                              right = pose * Eigen::Vector3d(half, 0, 0);
        const QColor laser = QColor::fromRgb(style::kVermilion);
        // The laser's fan ends in its line; the frustum's edges show what the camera sees before and behind.
        painter.triangle(source, left, right, faded(laser, chosen ? 90 : 34));
        painter.line(left, right, laser);
        const QColor edge = chosen ? style::selection(palette) : faded(style::axis(palette), 130);
        painter.line(source, left, edge);
        painter.line(source, right, edge);
        if (!chosen) continue;
        const double deep = 0.3 * spot.field_mm;
        Eigen::Vector3d near[2], far[2];
        for (int i = 0; i < 2; ++i) {
            const double x = i == 0 ? -half : half;
            near[i] = pose * Eigen::Vector3d(x * (1 - deep / spot.stand_off_mm), 0, deep);
            far[i] = pose * Eigen::Vector3d(x * (1 + deep / spot.stand_off_mm), 0, -deep);
        }
        painter.line(near[0], near[1], edge);
        painter.line(far[0], far[1], edge);
        for (int i = 0; i < 2; ++i) painter.line(near[i], far[i], edge);
        painter.box(pose, Eigen::Vector3d(-45, -22, spot.stand_off_mm),
                    Eigen::Vector3d(45, 60, spot.stand_off_mm + 50), faded(style::axis(palette), 120));
    }
    return painter.take();
}

std::optional<WeakArrow> weak_arrow(const SceneRegion& region, const std::vector<SceneSpot>& spots) {
    if (!(region.weak_direction.norm() > 1e-9)) return std::nullopt;
    const auto centre = lifted_centre(region, spots);
    if (!centre) return std::nullopt;
    return WeakArrow{*centre, *centre + 160 * region.weak_direction.normalized()};
}

vtkSmartPointer<vtkPolyData> draw_regions(const std::vector<SceneRegion>& regions,
                                          const std::vector<SceneSpot>& spots, const std::string& selected,
                                          const QPalette& palette) {
    ScenePainter painter;
    int number = 0;
    for (const SceneRegion& region : regions) {
        const QColor colour = style::segment(number++, palette);
        const bool chosen = region.id == selected;
        std::vector<Eigen::Vector3d> members;
        for (const SceneSpot& spot : spots)
            if (std::find(region.spot_ids.begin(), region.spot_ids.end(), spot.id) != region.spot_ids.end())
                members.push_back(reference_of(spot));
        if (members.empty()) continue;
        const Eigen::Vector3d centre = *lifted_centre(region, spots);
        for (const auto& p : members) painter.line(centre, p, colour);
        if (members.size() >= 3) {
            const Eigen::Vector3d first = (members[0] - centre);
            Eigen::Vector3d normal = Eigen::Vector3d::Zero();
            for (const auto& p : members)
                if (first.cross(p - centre).norm() > normal.norm()) normal = first.cross(p - centre);
            if (normal.norm() > 1e-6) {
                const Eigen::Vector3d u = first.normalized(), v = normal.normalized().cross(u);
                std::sort(members.begin(), members.end(),
                          [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
                              return std::atan2((a - centre).dot(v), (a - centre).dot(u)) <
                                     std::atan2((b - centre).dot(v), (b - centre).dot(u));
                          });
                for (std::size_t i = 0; i < members.size(); ++i)
                    painter.triangle(centre, members[i], members[(i + 1) % members.size()],
                                     faded(colour, chosen ? 80 : 30));
            }
        }
        if (const auto weak = weak_arrow(region, spots)) {
            painter.arrow(weak->centre, weak->tip, 12, style::alarm(palette));
            painter.arrow(weak->centre, 2 * weak->centre - weak->tip, 12, style::alarm(palette));
        }
    }
    return painter.take();
}

vtkSmartPointer<vtkPolyData> draw_corrections(const std::vector<SceneSpot>& spots, double scale,
                                              const QPalette& palette) {
    ScenePainter painter;
    for (const SceneSpot& spot : spots)
        if (spot.shift_mm && spot.shift_mm->allFinite())
            painter.arrow(reference_of(spot), reference_of(spot) + scale * *spot.shift_mm, 5,
                          style::selection(palette));
    return painter.take();
}

std::vector<Eigen::Vector3d> drawn_path(const ScenePath& path, double scale) {
    std::vector<Eigen::Vector3d> drawn = path.after_mm;
    if (path.after_mm.size() != path.before_mm.size()) return drawn;
    // The same exaggeration as the arrows, or a millimetre would not be seen on a metre.
    for (std::size_t i = 0; i < drawn.size(); ++i)
        drawn[i] = path.before_mm[i] + scale * (path.after_mm[i] - path.before_mm[i]);
    return drawn;
}

std::optional<WorstPathPoint> worst_of(const ScenePath& path) {
    if (path.after_mm.empty() || path.after_mm.size() != path.before_mm.size()) return std::nullopt;
    WorstPathPoint worst;
    for (std::size_t i = 0; i < path.after_mm.size(); ++i) {
        const double shift = (path.after_mm[i] - path.before_mm[i]).norm();
        if (!(shift > worst.shift_mm)) continue;
        worst = {i, shift, i < path.sigma_mm.size() ? path.sigma_mm[i] : 0};
    }
    return worst;
}

vtkSmartPointer<vtkPolyData> draw_path(const ScenePath& path, double scale, const QPalette& palette) {
    ScenePainter painter;
    const auto segments = [&](std::size_t points, const auto& draw) {
        for (std::size_t i = 1; i < points; ++i) draw(i - 1, i);
        if (path.closed && points > 2) draw(points - 1, std::size_t{0});
    };
    segments(path.before_mm.size(), [&](std::size_t a, std::size_t b) {
        painter.line(path.before_mm[a], path.before_mm[b], style::axis(palette));
    });
    const std::vector<Eigen::Vector3d> after = drawn_path(path, scale);
    const auto worst = worst_of(path);
    const auto colour = [&](std::size_t i) {
        if (!worst || !(worst->shift_mm > 0)) return style::attention(palette);
        const double share = (path.after_mm[i] - path.before_mm[i]).norm() / worst->shift_mm;
        const QColor least = QColor::fromRgb(style::kSkyBlue), most = QColor::fromRgb(style::kVermilion);
        const auto mixed = [&](int a, int b) { return static_cast<int>(std::lround(a + share * (b - a))); };
        return QColor(mixed(least.red(), most.red()), mixed(least.green(), most.green()),
                      mixed(least.blue(), most.blue()));
    };
    constexpr int kTubeAlpha = 70;
    segments(after.size(), [&](std::size_t a, std::size_t b) {
        painter.line(after[a], after[b], colour(a));
        if (path.sigma_mm.size() == after.size())
            painter.tube(after[a], 3 * scale * path.sigma_mm[a], after[b], 3 * scale * path.sigma_mm[b],
                         faded(colour(a), kTubeAlpha));
    });
    return painter.take();
}

vtkSmartPointer<vtkPolyData> draw_edges(const std::vector<SceneEdge>& edges,
                                        const std::vector<std::string>& chosen, const std::string& lit,
                                        const std::vector<SceneSpot>& proposed, const QPalette& palette) {
    constexpr double kThick = 1.2, kGhost = 3, kLook = 40;  // mm
    ScenePainter painter;
    const QColor quiet = style::quiet_text(palette), strong = style::selection(palette);
    for (const SceneEdge& edge : edges) {
        const bool taken = std::find(chosen.begin(), chosen.end(), edge.id) != chosen.end();
        const bool on = edge.id == lit;
        for (std::size_t i = 1; i < edge.points_mm.size(); ++i) {
            const Eigen::Vector3d &a = edge.points_mm[i - 1], &b = edge.points_mm[i];
            if (taken || on)
                painter.tube(a, kThick, b, kThick, on && !taken ? strong.lighter(130) : strong);
            else
                painter.line(a, b, quiet);
        }
    }
    for (const SceneSpot& spot : proposed) {
        const Eigen::Vector3d at = spot.workobject_from_sensor * spot.reference_mm;
        const Eigen::Vector3d up = -(spot.workobject_from_sensor.linear() * Eigen::Vector3d::UnitZ());
        painter.ball(at, kGhost, strong);
        painter.line(at, at + kLook * up, strong);
    }
    return painter.take();
}

vtkSmartPointer<vtkPolyData> draw_robot(const std::optional<SceneRobot>& robot,
                                        const std::optional<SceneRobot>& next, const QPalette& palette) {
    ScenePainter painter;
    const auto stand = [&](const SceneRobot& at, const QColor& line, const QColor& body, int alpha) {
        painter.axes(at.workobject_from_flange, 90, 5, alpha);
        painter.line(at.workobject_from_flange.translation(), at.workobject_from_sensor.translation(), line);
        painter.axes(at.workobject_from_sensor, 60, 4, alpha);
        painter.box(at.workobject_from_flange, Eigen::Vector3d(-40, -40, -14), Eigen::Vector3d(40, 40, 0),
                    body);
        painter.box(at.workobject_from_sensor, Eigen::Vector3d(-45, -22, 300), Eigen::Vector3d(45, 60, 350),
                    body);
    };
    if (robot) stand(*robot, style::axis(palette), faded(style::text(palette), 90), 255);
    const QColor blue = style::selection(palette);
    if (next) stand(*next, faded(blue, 130), faded(blue, 90), 130);
    return painter.take();
}

}  // namespace seamwright
