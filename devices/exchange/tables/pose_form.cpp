#include "devices/exchange/tables/pose_form.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/geometry/notation.h"
#include "core/profile/units.h"
#include "devices/exchange/tables/csv_table.h"

namespace seamwright {
namespace {

constexpr double kNearForMillimetres = 100;  // no robot measures with its flange within 100 mm of its base

Expected<Eigen::Matrix3d> rotation(const PoseForm& form, const std::vector<double>& n,
                                   const std::string& at) {
    const double deg = form.rad * 180 / kPi;
    if (form.convention == "kuka-abc") return rotation_from_kuka({n[3] * deg, n[4] * deg, n[5] * deg});
    if (form.convention == "fanuc-wpr" || form.convention == "rpy")
        return rotation_from_fanuc({n[3] * deg, n[4] * deg, n[5] * deg});
    if (form.convention == "ur-rotvec") return rotation_exp(form.rad * Eigen::Vector3d(n[3], n[4], n[5]));
    if (form.convention == "zyz") return rotation_from_zyz({n[3] * deg, n[4] * deg, n[5] * deg});
    if (form.convention == "quat-wxyz") return rotation_from_abb({n[3], n[4], n[5], n[6]}, at);
    return rotation_from_abb({n[6], n[3], n[4], n[5]}, at);
}

// One pose in metres among others in millimetres: it stands next to the base, and a thousandfold where the others do.
Expected<void> check_one_unit(const std::vector<WrittenRow>& rows, bool matrix) {
    constexpr double kNear = 10, kAlike = 3;
    const auto reach = [&](const WrittenRow& row) {
        const auto& n = row.numbers;
        return matrix ? std::hypot(n[3], n[7], n[11]) : std::hypot(n[0], n[1], n[2]);
    };
    std::vector<double> reaches;
    for (const WrittenRow& row : rows) reaches.push_back(reach(row));
    const auto middle = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
    std::nth_element(reaches.begin(), middle, reaches.end());
    for (const WrittenRow& row : rows) {
        const double mm = reach(row), if_metres = 1000 * mm;
        if (mm<kNear&& * middle> kNearForMillimetres && if_metres > *middle / kAlike &&
            if_metres < *middle * kAlike)
            return input_error(
                Text("its position is {:.4g} from the base where the others are about {:.4g}: metres among "
                     "millimetres",
                     mm, *middle),
                row.at, "write all positions in one unit, or say with --pose-unit mm that they are");
    }
    return {};
}

}  // namespace

Expected<PoseForm> pose_form(const PoseLayout& layout) {
    PoseForm form{layout.convention, 0, 0};
    if (!layout.convention.empty() && std::find(std::begin(kPoseConventions), std::end(kPoseConventions),
                                                layout.convention) == std::end(kPoseConventions))
        return usage_error(Text("\"{}\" is no convention of poses", csv::shown(layout.convention)),
                           "--pose-convention");
    if (!layout.unit.empty()) {
        const auto mm = mm_of_unit(layout.unit);
        if (!mm)
            return usage_error(Text("\"{}\" is no unit of length", csv::shown(layout.unit)), "--pose-unit");
        form.mm = *mm;
    }
    if (!layout.angle.empty()) {
        if (layout.angle != "deg" && layout.angle != "rad")
            return usage_error(Text("\"{}\" is no unit of angle", csv::shown(layout.angle)), "--pose-angle");
        form.rad = layout.angle == "deg" ? kPi / 180 : 1;
    }
    return form;
}

Expected<void> check_said(const PoseLayout& layout, const WrittenNotation& notation,
                          const std::string& where) {
    using Said = std::tuple<const char*, const std::string&, const std::string&>;
    for (const auto& [option, said, is] : {Said{"--pose-convention", layout.convention, notation.convention},
                                           Said{"--pose-unit", layout.unit, notation.unit},
                                           Said{"--pose-angle", layout.angle, notation.angle}}) {
        if (said.empty() || is.empty() || said == is || (said == "rpy" && is == "fanuc-wpr")) continue;
        if (is == kNoAngles)
            return input_error(Text("{} cannot act: the poses are written without angles", option), where,
                               Text("leave {} out", option));
        return input_error(Text("{} {} cannot act: by its notation it is {}", option, said, is), where,
                           Text("leave {} out", option));
    }
    return {};
}

Pose brought_to_flange(const Pose& pose, const PoseLayout& layout) {
    return layout.base_from_user_frame.value_or(Pose::Identity()) * pose *
           layout.flange_from_tool.value_or(Pose::Identity()).inverse();
}

Expected<Pose> pose_of(const PoseForm& form, const WrittenRow& row) {
    const auto& n = row.numbers;
    if (form.convention == "matrix") {
        Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
        for (std::size_t i = 0; i < n.size(); ++i)
            m(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = n[i];
        if (n.size() == 16 && m.col(3).head<3>().isZero(1e-9) && !m.row(3).head<3>().isZero(1e-9))
            return input_error("the position stands in the last row of the matrix", row.at,
                               "write it transposed");
        m.col(3).head<3>() *= form.mm;
        if (m.col(3).head<3>().cwiseAbs().maxCoeff() > kFarthestPose_mm)
            return input_error("the position exceeds 100 m", row.at, "say the unit with --pose-unit");
        return pose_from_matrix(m, row.at);
    }
    const Eigen::Vector3d t = form.mm * Eigen::Vector3d(n[0], n[1], n[2]);
    if (t.cwiseAbs().maxCoeff() > kFarthestPose_mm)
        return input_error("the position exceeds 100 m", row.at, "say the unit with --pose-unit");
    SEAM_TRY(auto r, rotation(form, n, row.at));
    return make_pose(r, t);
}

Expected<void> settle_units(PoseForm& form, const std::vector<WrittenRow>& rows, const std::string& where) {
    const bool matrix = form.convention == "matrix";
    double farthest = 0, widest = 0;
    for (const WrittenRow& row : rows) {
        for (std::size_t i = 0; i < 3; ++i)
            farthest = std::max(farthest, std::abs(row.numbers[matrix ? 4 * i + 3 : i]));
        for (std::size_t i = 3; !matrix && i < 6; ++i) widest = std::max(widest, std::abs(row.numbers[i]));
    }
    if (form.mm == 0) {
        if (farthest > 0 && farthest < kNearForMillimetres)
            return input_error(
                Text("no position is farther than {:.4g}, which looks like metres or inches", farthest),
                where, "say the unit with --pose-unit mm, m or in");
        if (farthest > kFarthestPose_mm)
            return input_error(Text("positions reach {:.4g}, which looks like micrometres", farthest), where,
                               "say the unit with --pose-unit mm or um");
        SEAM_OK(check_one_unit(rows, matrix));
        form.mm = 1;
    }
    const bool angles = !matrix && !form.convention.starts_with("quat");
    if (angles && form.rad == 0) {
        const bool radian = form.convention == "ur-rotvec";
        if (radian ? widest > 2 * kPi + 1e-6 : widest > 0 && widest <= 2 * kPi)
            return input_error(
                Text("no angle exceeds {:.4g}, which looks like {}", widest, radian ? "degrees" : "radian"),
                where, "say the unit with --pose-angle deg or rad");
        form.rad = radian ? 1 : kPi / 180;
    }
    return {};
}

Expected<void> check_width(PoseForm& form, std::size_t width, const std::string& where) {
    if (form.convention.empty()) {
        if (width == 12 || width == 16) {
            form.convention = "matrix";
        } else if (width == 6) {
            return input_error("six numbers are a pose in several ways", where,
                               "say which with --pose-convention kuka-abc, fanuc-wpr, rpy, ur-rotvec or zyz");
        } else if (width == 7) {
            return input_error("seven numbers are a frame's number and six, or a position and a quaternion",
                               where,
                               "say which with --pose-convention: one of the six, or quat-wxyz or quat-xyzw");
        }
    }
    const bool fits = form.convention == "matrix"           ? width == 12 || width == 16
                      : form.convention.starts_with("quat") ? width == 7
                                                            : width == 6;
    if (!fits)
        return input_error(form.convention.empty()
                               ? Text("{} numbers are no pose", width)
                               : Text("{} numbers are no pose of the form {}", width, form.convention),
                           where, "give x, y, z and a rotation, or a 4x4 matrix");
    return {};
}

}  // namespace seamwright
