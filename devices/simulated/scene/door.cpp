#include "devices/simulated/scene/door.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kHalfX = 455, kHalfY = 365, kShear = 0.10, kExponent = 5;
constexpr double kFlangeTop = kDoorFlangeTop_mm, kFlangeEnd = 9.0, kLand = 0.7;
constexpr double kFoldRadius = 1.15, kFoldHeight = 0.35;
constexpr double kRimWidth = 60, kPanelHeight = 15;
const Vector2d kCentre(500, 375);

// Inner face of the outer skin: barrel in both directions and a styling line.
double skin(double x, double y) {
    const double line = (y - 455) / 30;
    return -(y - 375) * (y - 375) / (2 * 1800) - (x - 500) * (x - 500) / (2 * 4500) +
           2.0 * std::exp(-line * line);
}

Vector3d skin_normal(double x, double y) {
    constexpr double h = 1e-3;
    const double dx = (skin(x + h, y) - skin(x - h, y)) / (2 * h),
                 dy = (skin(x, y + h) - skin(x, y - h)) / (2 * h);
    return Vector3d(-dx, -dy, 1).normalized();
}

Vector2d outline(double phi) {
    const double c = std::cos(phi), s = std::sin(phi);
    const double r =
        std::pow(std::pow(std::abs(c) / kHalfX, kExponent) + std::pow(std::abs(s) / kHalfY, kExponent),
                 -1 / kExponent);
    return kCentre + Vector2d(r * c + kShear * r * s, r * s);
}

Vector3d on_skin(const Vector2d& p) {
    return {p.x(), p.y(), skin(p.x(), p.y())};
}

// Arc length along the outline, tabulated over the angle.
class Outline {
  public:
    Outline() {
        arc_.resize(kSteps + 1);
        Vector3d last = on_skin(outline(0));
        for (int i = 1; i <= kSteps; ++i) {
            const Vector3d next = on_skin(outline(angle(i)));
            arc_[static_cast<std::size_t>(i)] = arc_[static_cast<std::size_t>(i) - 1] + (next - last).norm();
            last = next;
        }
    }
    double length() const { return arc_.back(); }
    double phi(double arc) const {
        arc = std::fmod(arc, length());
        if (arc < 0) arc += length();
        const auto it = std::upper_bound(arc_.begin(), arc_.end(), arc);
        const int i = std::clamp(static_cast<int>(it - arc_.begin()) - 1, 0, kSteps - 1);
        const double a = arc_[static_cast<std::size_t>(i)], b = arc_[static_cast<std::size_t>(i) + 1];
        return angle(i) + (arc - a) / (b - a) * (2 * kPi / kSteps);
    }

  private:
    static constexpr int kSteps = 40000;
    static double angle(int i) { return 2 * kPi * i / kSteps; }
    std::vector<double> arc_;
};

const Outline& the_outline() {
    static const Outline o;
    return o;
}

double smooth_step(double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

// Cross-section of the rim: (t inboard, height over the outer skin's inner face), from below the fold to the
// panel.
std::vector<Vector2d> cross_section() {
    std::vector<Vector2d> c = {{8, kFoldHeight - kFoldRadius}};
    for (int i = 0; i <= 18; ++i) {
        const double a = -kPi / 2 - kPi * i / 18;
        c.emplace_back(kFoldRadius + kFoldRadius * std::cos(a), kFoldHeight + kFoldRadius * std::sin(a));
    }
    for (double t : {3.0, 5.0, 7.0}) c.emplace_back(t, kFlangeTop);
    constexpr double r = 0.2;  // broken edge of the flange's end
    for (int i = 0; i <= 4; ++i) {
        const double a = kPi / 2 - kPi / 2 * i / 4;
        c.emplace_back(kFlangeEnd - r + r * std::cos(a), kFlangeTop - r + r * std::sin(a));
    }
    for (double t : {kFlangeEnd + 1e-3, 12.0, 16.0, 20.0, 24.0, 27.0}) c.emplace_back(t, kLand);
    for (int i = 1; i <= 14; ++i) c.emplace_back(27 + 18.0 * i / 14, kLand + 14 * smooth_step(i / 14.0));
    c.emplace_back(52, 14.85);
    c.emplace_back(kRimWidth, kPanelHeight);
    return c;
}

// Raised bead along a line: height above the panel.
double bead(double x, double y, const Vector2d& a, const Vector2d& b, double half_width, double height) {
    const Vector2d d = b - a, p(x, y);
    const double s = std::clamp(d.dot(p - a) / d.squaredNorm(), 0.0, 1.0);
    return height * smooth_step(1.6 - 1.6 * (p - a - s * d).norm() / half_width);
}

double panel(double x, double y) {
    double z = skin(x, y) + kPanelHeight;
    z += bead(x, y, {250, 250}, {520, 290}, 22, 6);
    z += bead(x, y, {260, 520}, {700, 545}, 18, 5);
    z += bead(x, y, {620, 180}, {800, 240}, 20, 6);
    const double pocket = std::hypot((x - 700) / 110, (y - 370) / 75);
    z -= 9 * smooth_step(3.5 - 3.5 * pocket);
    return z;
}

struct Hole {
    double x, y, radius;
};
constexpr Hole kHoles[] = {{330, 380, 32}, {480, 400, 22}, {250, 420, 12},
                           {540, 190, 16}, {800, 480, 14}, {400, 180, 10}};

}  // namespace

std::vector<DoorSectionPoint> door_rim_section() {
    std::vector<DoorSectionPoint> points;
    for (const Vector2d& c : cross_section()) points.push_back({c.x(), c.y()});
    return points;
}

double door_edge_length_mm() {
    return the_outline().length();
}

DoorEdge door_edge(double arc_mm) {
    const double phi = the_outline().phi(arc_mm);
    constexpr double h = 1e-5;
    const Vector2d p = outline(phi);
    DoorEdge e;
    e.point_mm = on_skin(p);
    e.up = skin_normal(p.x(), p.y());
    const Vector3d tangent = on_skin(outline(phi + h)) - on_skin(outline(phi - h));
    e.along = (tangent - e.up * e.up.dot(tangent)).normalized();
    e.inboard = e.up.cross(e.along);  // the outline runs anticlockwise, so the inside is on the left
    return e;
}

TriangleMesh door_mesh() {
    TriangleMesh mesh;
    const auto section = cross_section();
    const int rows = static_cast<int>(section.size());
    constexpr int kFine = 1920, kCoarse = kFine / 4, kRings = 90;
    mesh.vertices.reserve(static_cast<std::size_t>(kFine * rows + kCoarse * kRings + 1));
    for (int i = 0; i < kFine; ++i) {
        const DoorEdge e = door_edge(door_edge_length_mm() * i / kFine);
        for (const Vector2d& c : section)
            mesh.vertices.push_back(e.point_mm + e.inboard * c.x() + e.up * c.y());
    }
    const auto rim = [&](int i, int row) { return (i % kFine) * rows + row; };
    for (int i = 0; i < kFine; ++i) {
        for (int r = 0; r + 1 < rows; ++r) {
            mesh.triangles.emplace_back(rim(i, r), rim(i + 1, r), rim(i, r + 1));
            mesh.triangles.emplace_back(rim(i + 1, r), rim(i + 1, r + 1), rim(i, r + 1));
        }
    }
    // The panel: rings shrinking towards the middle, a quarter as many points around.
    const int first = static_cast<int>(mesh.vertices.size());
    const Vector2d middle = kCentre;
    std::vector<Vector3d> border;
    for (int i = 0; i < kCoarse; ++i)
        border.push_back(mesh.vertices[static_cast<std::size_t>(rim(4 * i, rows - 1))]);
    const auto inner = [&](int i, int ring) { return first + ring * kCoarse + i % kCoarse; };
    for (int ring = 0; ring < kRings; ++ring) {
        const double rho = 1.0 - (ring + 1.0) / (kRings + 1.0);
        for (const Vector3d& b : border) {
            Vector2d p = middle + rho * (b.head<2>() - middle);
            for (const Hole& hole :
                 kHoles) {  // vertices near a hole's rim go onto it, so that the hole is round
                const Vector2d d = p - Vector2d(hole.x, hole.y);
                if (std::abs(d.norm() - hole.radius) < 2.4 && d.norm() > 1)
                    p = Vector2d(hole.x, hole.y) + d.normalized() * hole.radius;
            }
            const double joined = (b.z() - panel(b.x(), b.y())) * std::pow(rho, 12);
            mesh.vertices.emplace_back(p.x(), p.y(), panel(p.x(), p.y()) + joined);
        }
    }
    const auto add = [&](int a, int b, int c) {
        const auto& v = mesh.vertices;
        const Vector3d m = (v[static_cast<std::size_t>(a)] + v[static_cast<std::size_t>(b)] +
                            v[static_cast<std::size_t>(c)]) /
                           3;
        for (const Hole& hole : kHoles) {
            if (std::hypot(m.x() - hole.x, m.y() - hole.y) < hole.radius - 0.05) return;
        }
        mesh.triangles.emplace_back(a, b, c);
    };
    for (int i = 0; i < kCoarse; ++i) {
        const int a = inner(i, 0), b = inner(i + 1, 0);
        for (int k = 0; k < 4; ++k)
            mesh.triangles.emplace_back(rim(4 * i + k, rows - 1), rim(4 * i + k + 1, rows - 1),
                                        k < 2 ? a : b);
        mesh.triangles.emplace_back(rim(4 * i + 2, rows - 1), b, a);
    }
    for (int ring = 0; ring + 1 < kRings; ++ring) {
        for (int i = 0; i < kCoarse; ++i) {
            add(inner(i, ring), inner(i + 1, ring), inner(i, ring + 1));
            add(inner(i + 1, ring), inner(i + 1, ring + 1), inner(i, ring + 1));
        }
    }
    mesh.vertices.emplace_back(middle.x(), middle.y(), panel(middle.x(), middle.y()));
    const int hub = static_cast<int>(mesh.vertices.size()) - 1;
    for (int i = 0; i < kCoarse; ++i)
        mesh.triangles.emplace_back(inner(i, kRings - 1), inner(i + 1, kRings - 1), hub);
    return mesh;
}

namespace {

// Arc position on a side: where the coordinate `axis` (0 = x, 1 = y) has `value`, among angles [from, from +
// 90 degrees).
double arc_at(int axis, double value, double from_deg) {
    double best = 0, best_error = 1e9;
    const double length = door_edge_length_mm();
    for (int i = 0; i < 7200; ++i) {
        const double arc = length * i / 7200;
        const Vector3d p = door_edge(arc).point_mm;
        double angle =
            deg_from_rad(std::atan2((p.y() - kCentre.y()) * kHalfX, (p.x() - kCentre.x()) * kHalfY)) -
            from_deg;
        angle -= 360 * std::floor(angle / 360);
        if (angle >= 90) continue;
        if (const double error = std::abs(p[axis] - value); error < best_error) {
            best_error = error;
            best = arc;
        }
    }
    return best;
}

struct Side {
    const char* letter;
    const char* id;
    int axis;
    double from_deg;
    std::vector<double> few, dense;  // where its spots are
};
const std::vector<Side>& sides() {
    static const std::vector<Side> all = {{"T", "top", 0, 45, {280, 530, 790}, {240, 300, 760, 820}},
                                          {"L", "latch", 1, -45, {190, 340, 580}, {160, 220, 530, 590}},
                                          {"B", "bottom", 0, 225, {220, 480, 720}, {190, 250, 690, 750}},
                                          {"H", "hinge", 1, 135, {190, 340, 580}, {160, 220, 530, 590}}};
    return all;
}

std::vector<DoorSpot> spots_at(std::vector<double> Side::*places) {
    std::vector<DoorSpot> spots;
    for (const Side& side : sides()) {
        for (std::size_t i = 0; i < (side.*places).size(); ++i) {
            const DoorEdge e = door_edge(arc_at(side.axis, (side.*places)[i], side.from_deg));
            DoorSpot spot;
            spot.id = side.letter + std::to_string(i + 1);
            Eigen::Matrix3d r;
            r.col(0) = e.inboard;
            r.col(2) = e.up;
            r.col(1) = e.up.cross(e.inboard);
            spot.workobject_from_sensor = make_pose(r, e.point_mm + 15.0 * e.inboard + kFlangeTop * e.up);
            spot.edge_mm = {-15, 0, 0};
            spots.push_back(spot);
        }
    }
    return spots;
}

}  // namespace

std::vector<DoorSpot> default_door_spots() {
    return spots_at(&Side::few);
}

std::vector<DoorSpot> dense_door_spots() {
    return spots_at(&Side::dense);
}

std::vector<DoorRegion> dense_door_regions() {
    return {{"top", {"T1", "T2", "T3", "T4", "H3", "H4", "L3", "L4"}},
            {"latch", {"L1", "L2", "L3", "L4", "T3", "T4", "B3", "B4"}},
            {"bottom", {"B1", "B2", "B3", "B4", "H1", "H2", "L1", "L2"}},
            {"hinge", {"H1", "H2", "H3", "H4", "T1", "T2", "B1", "B2"}}};
}

std::vector<DoorRegion> default_door_regions() {
    return {{"top", {"T1", "T2", "T3", "H3", "L3"}},
            {"latch", {"L1", "L2", "L3", "T3", "B3", "B2"}},
            {"bottom", {"B1", "B2", "B3", "H1", "L1"}},
            {"hinge", {"H1", "H2", "H3", "T1", "B1", "T2"}}};
}

std::vector<Vector3d> door_bead_path(double step_mm) {
    std::vector<Vector3d> path;
    const int n = std::max(8, static_cast<int>(door_edge_length_mm() / std::max(step_mm, 0.1)));
    for (int i = 0; i < n; ++i) {
        const DoorEdge e = door_edge(door_edge_length_mm() * i / n);
        path.push_back(e.point_mm + 10.5 * e.inboard + kLand * e.up);
    }
    return path;
}

std::string door_side_of(const Vector3d& p) {
    double angle = deg_from_rad(std::atan2((p.y() - kCentre.y()) * kHalfX, (p.x() - kCentre.x()) * kHalfY));
    angle -= 360 * std::floor(angle / 360);
    if (angle < 45 || angle >= 315) return "latch";
    if (angle < 135) return "top";
    return angle < 225 ? "hinge" : "bottom";
}

double bend_at(const PartBend& bend, const Eigen::AlignedBox3d& box, const Vector3d& p) {
    if (bend.bend_mm == 0 && bend.twist_mm == 0) return 0;
    const Vector3d size = box.sizes().cwiseMax(1e-9);
    const double x = (p.x() - box.min().x()) / size.x(), y = (p.y() - box.min().y()) / size.y();
    return bend.bend_mm * x * x + bend.twist_mm * x * (2 * y - 1);
}

TriangleMesh sphere_mesh(double radius_mm) {
    TriangleMesh mesh;
    // Sagitta of a facet with edge L: L^2 / (8 r) <= 0.002.
    const int rings =
        std::clamp(static_cast<int>(kPi * radius_mm / std::sqrt(8 * radius_mm * 0.002)) + 1, 24, 600);
    const int around = 2 * rings;
    for (int i = 0; i <= rings; ++i) {
        const double theta = kPi * i / rings;
        for (int k = 0; k < around; ++k) {
            const double phi = 2 * kPi * k / around;
            mesh.vertices.emplace_back(radius_mm * std::sin(theta) * std::cos(phi),
                                       radius_mm * std::sin(theta) * std::sin(phi),
                                       radius_mm * std::cos(theta));
        }
    }
    for (int i = 0; i < rings; ++i) {
        for (int k = 0; k < around; ++k) {
            const int a = i * around + k, b = i * around + (k + 1) % around, c = a + around, d = b + around;
            if (i > 0) mesh.triangles.emplace_back(a, c, b);
            if (i + 1 < rings) mesh.triangles.emplace_back(b, c, d);
        }
    }
    return mesh;
}

TriangleMesh plate_mesh(double width_mm, double height_mm) {
    const double x = width_mm / 2, y = height_mm / 2;
    TriangleMesh mesh;
    mesh.vertices = {{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

TriangleMesh triangle_body_mesh() {
    TriangleMesh mesh = plate_mesh(200, 200);
    for (double y : {-100.0, 100.0}) {
        mesh.vertices.emplace_back(-30, y, 0);
        mesh.vertices.emplace_back(30, y, 0);
        mesh.vertices.emplace_back(0, y, 30);
    }
    for (const auto& t : std::initializer_list<Eigen::Vector3i>{
             {4, 6, 9}, {4, 9, 7}, {5, 8, 9}, {5, 9, 6}, {4, 5, 6}, {7, 9, 8}}) {
        mesh.triangles.push_back(t);
    }
    return mesh;
}

}  // namespace seamwright
