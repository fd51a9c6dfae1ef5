#include "devices/exchange/tables/path_csv.h"

#include <fmt/format.h>

#include <array>

#include "core/geometry/notation.h"
#include "devices/exchange/files.h"
#include "devices/exchange/tables/csv_table.h"

namespace seamwright {
namespace {

struct Columns {
    std::array<std::string_view, 8> names;  // numbers, then the region
    std::size_t numbers;
    double mm;  // of one unit of length
};

Columns columns_of(PathNotation notation) {
    switch (notation) {
        case PathNotation::kuka:
            return {{"x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg", "region"}, 6, 1};
        case PathNotation::abb:
            return {{"x_mm", "y_mm", "z_mm", "q1", "q2", "q3", "q4", "region"}, 7, 1};
        default:
            return {{"x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad", "region"}, 6, 1000};
    }
}

Expected<Pose> pose_of(const std::array<double, 7>& v, PathNotation notation, double mm,
                       const std::string& where) {
    const Eigen::Vector3d t = mm * Eigen::Vector3d(v[0], v[1], v[2]);
    if (t.cwiseAbs().maxCoeff() > 1e5)
        return input_error("the point lies beyond 100 m", where,
                           mm > 1 ? "lengths of this notation are metres" : "give millimetres");
    if (notation == PathNotation::abb) {
        SEAM_TRY(auto r, rotation_from_abb({v[3], v[4], v[5], v[6]}, where));
        return make_pose(r, t);
    }
    const Eigen::Vector3d w(v[3], v[4], v[5]);
    const double most = notation == PathNotation::kuka ? 720 : 2 * kPi + 1e-6;
    if (w.cwiseAbs().maxCoeff() > most || (notation == PathNotation::ur && w.norm() > most))
        return input_error("the angles are beyond any that a robot writes", where,
                           notation == PathNotation::kuka ? "give degrees" : "give radians");
    return make_pose(
        notation == PathNotation::kuka ? rotation_from_kuka({v[3], v[4], v[5]}) : rotation_from_ur(w), t);
}

}  // namespace

Expected<PathNotation> path_notation_from(std::string_view brand) {
    for (std::size_t i = 0; i < std::size(kPathNotations); ++i)
        if (kPathNotations[i] == brand) return static_cast<PathNotation>(i);
    return usage_error(Text("no robot writes poses as \"{}\"", brand), "", "give kuka, abb or ur");
}

std::string_view to_string(PathNotation notation) {
    return kPathNotations[static_cast<std::size_t>(notation)];
}

Expected<ApplicationPath> parse_path_csv(std::string_view text, PathNotation notation,
                                         const std::string& where) {
    const Columns columns = columns_of(notation);
    CsvTable table(text, where, "[,region]");
    SEAM_OK(table.header({columns.names.data(), columns.numbers + 1}, columns.numbers));
    ApplicationPath path;
    path.regions_named = table.has(columns.numbers);
    for (;;) {
        SEAM_TRY(const auto more, table.row());
        if (!more) break;
        if (path.points.size() >= kPathPointLimit)
            return input_error(Text("there are more than {} points", kPathPointLimit), table.at());
        std::array<double, 7> v{};
        for (std::size_t c = 0; c < columns.numbers; ++c) {
            SEAM_TRY(const auto number, table.number(c, columns.names[c]));
            if (!std::isfinite(number))
                return input_error(Text("{} is missing", columns.names[c]), table.at());
            v[c] = number;
        }
        SEAM_TRY(const auto pose, pose_of(v, notation, columns.mm, table.at()));
        path.points.push_back({pose, path.regions_named ? table.text(columns.numbers) : std::string()});
    }
    if (path.points.empty()) return input_error("the path has no points", where);
    return path;
}

Expected<ApplicationPath> read_path_csv(const std::filesystem::path& path, PathNotation notation) {
    SEAM_TRY(const auto text, read_text_file(path));
    return parse_path_csv(text, notation, path.string());
}

std::string path_csv(const ApplicationPath& path, PathNotation notation) {
    const Columns columns = columns_of(notation);
    fmt::memory_buffer out;
    const auto put = [&](std::string_view s) { out.append(s.data(), s.data() + s.size()); };
    for (std::size_t c = 0; c < columns.numbers + path.regions_named; ++c) {
        if (c > 0) put(",");
        put(columns.names[c]);
    }
    put("\n");
    for (const ApplicationPoint& point : path.points) {
        const Eigen::Vector3d t = point.frame_from_tool.translation() / columns.mm;
        const Eigen::Matrix3d& r = point.frame_from_tool.linear();
        fmt::format_to(std::back_inserter(out), "{},{},{}", t.x(), t.y(), t.z());
        if (notation == PathNotation::kuka) {
            const KukaAbc abc = kuka_from_rotation(r);
            fmt::format_to(std::back_inserter(out), ",{},{},{}", abc.a_deg, abc.b_deg, abc.c_deg);
        } else if (notation == PathNotation::abb) {
            const AbbQuaternion q = abb_from_rotation(r);
            fmt::format_to(std::back_inserter(out), ",{},{},{},{}", q.w, q.x, q.y, q.z);
        } else {
            const Eigen::Vector3d w = ur_from_rotation(r);
            fmt::format_to(std::back_inserter(out), ",{},{},{}", w.x(), w.y(), w.z());
        }
        if (path.regions_named) put("," + csv::field(point.region_id));
        put("\n");
    }
    return fmt::to_string(out);
}

}  // namespace seamwright
