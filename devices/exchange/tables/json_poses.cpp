#include "devices/exchange/tables/json_poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "devices/exchange/files.h"
#include "devices/exchange/json_fields.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/tables/csv_table.h"
#include "devices/exchange/tables/pose_form.h"
#include "devices/exchange/written_pose.h"

namespace seamwright {
namespace {

constexpr double kMostAngle_deg = 720;
constexpr double kTurnWithin = 2e-3;  // of a half or a quarter turn, rad

bool of_radian(const std::vector<WrittenRow>& rows) {
    std::vector<double> angles;
    for (const WrittenRow& row : rows)
        angles.insert(angles.end(), row.numbers.begin() + 3, row.numbers.begin() + 6);
    return turns_of_radian(angles);
}

// Poses of one notation, each with its place among all.
struct Alike {
    PoseForm form;
    std::vector<WrittenRow> rows;
    std::vector<std::size_t> places;
};

class JsonPoses {
  public:
    explicit JsonPoses(const PoseLayout& layout) : layout_(layout) {}

    Expected<void> add(const nlohmann::json& json, const std::string& at) {
        SEAM_TRY(const auto written, written_pose(json, at));
        if (json.contains("matrix") && json.contains("abc")) return add_own(json, at);
        WrittenNotation notation{"matrix", "", kNoAngles};
        switch (written.as_given.rotation) {
            case RotationReading::matrix:
                break;
            case RotationReading::rotation_vector:
                notation = {"ur-rotvec", "", "rad"};
                break;
            case RotationReading::quat_wxyz:
                notation.convention = "quat-wxyz";
                break;
            default:
                notation = {"kuka-abc", "", ""};
        }
        SEAM_OK(check_said(layout_, notation, at));
        WrittenRow row{at, {}};
        const auto& n = written.numbers;
        if (n.form == RotationForm::matrix) {
            if (n.position_in_last_row)
                return input_error("the position stands in the last row of the matrix", at,
                                   "write it transposed");
            for (std::size_t r = 0; r < 3; ++r)
                row.numbers.insert(row.numbers.end(),
                                   {n.rotation[3 * r], n.rotation[3 * r + 1], n.rotation[3 * r + 2],
                                    n.position[static_cast<Eigen::Index>(r)]});
        } else {
            row.numbers.assign(n.position.data(), n.position.data() + 3);
            row.numbers.insert(row.numbers.end(), n.rotation.begin(),
                               n.rotation.begin() + (n.form == RotationForm::quaternion ? 4 : 3));
        }
        SEAM_TRY(PoseForm form, pose_form(layout_));
        form.convention = notation.convention;
        if (notation.angle == "rad") form.rad = 1;
        put(notation.convention, form, std::move(row));
        return {};
    }

    Expected<std::vector<Pose>> poses(const std::string& where) {
        std::vector<Pose> all(count_, Pose::Identity());
        for (auto& [notation, alike] : alike_) {
            PoseForm& form = alike.form;
            if (form.convention == "kuka-abc" && form.rad == 0 && !of_radian(alike.rows))
                form.rad = kPi / 180;
            SEAM_OK(settle_units(form, alike.rows, where));
            for (std::size_t i = 0; i < alike.rows.size(); ++i) {
                const WrittenRow& row = alike.rows[i];
                const Eigen::Vector3d angles(row.numbers[3], row.numbers[4], row.numbers[5]);
                if (form.convention == "kuka-abc" &&
                    angles.cwiseAbs().maxCoeff() * form.rad > kMostAngle_deg * kPi / 180)
                    return input_error("an angle exceeds 720", row.at, "give degrees");
                if (form.convention == "ur-rotvec" && angles.norm() > 2 * kPi + 1e-6)
                    return input_error("the rotation vector is longer than one turn", row.at, "give radian");
                SEAM_TRY(all[alike.places[i]], pose_of(form, row));
            }
        }
        return all;
    }

    std::string understood() const {
        std::string text = fmt::format("{} JSON poses", count_);
        for (const auto& [notation, alike] : alike_) {
            text += fmt::format(", {}, {} mm a unit", alike.form.convention, alike.form.mm);
            if (alike.form.convention == "kuka-abc") text += alike.form.rad == 1 ? ", radian" : ", degrees";
        }
        return text;
    }
    std::size_t size() const { return count_; }

  private:
    // The matrix counts.
    Expected<void> add_own(const nlohmann::json& json, const std::string& at) {
        SEAM_OK(check_said(layout_, {"kuka-abc", "mm", "deg"}, at));
        SEAM_TRY(const auto pose, parse_pose(json, at));
        WrittenRow row{at, {}};
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 4; ++c) row.numbers.push_back(pose.matrix()(r, c));
        put("of our own", {"matrix", 1, kPi / 180}, std::move(row));
        return {};
    }
    void put(const std::string& group, const PoseForm& form, WrittenRow row) {
        Alike& alike = alike_[group];
        alike.form = form;
        alike.rows.push_back(std::move(row));
        alike.places.push_back(count_++);
    }

    const PoseLayout& layout_;
    std::map<std::string, Alike> alike_;
    std::size_t count_ = 0;
};

}  // namespace

bool turns_of_radian(std::span<const double> angles) {
    bool turned = false;
    for (const double signed_angle : angles) {
        const double angle = std::abs(signed_angle);
        if (!(angle <= kPi + kTurnWithin)) return false;
        turned = turned || std::abs(angle - kPi) < kTurnWithin || std::abs(angle - kPi / 2) < kTurnWithin;
    }
    return turned;
}

Expected<PoseTable> parse_json_poses(std::string_view text, const std::string& where,
                                     const PoseLayout& layout) {
    SEAM_TRY(const auto json, parse_json(text, where));
    JsonPoses read(layout);
    PoseTable table;
    std::vector<std::string> places;
    if (json.is_array()) {
        for (std::size_t i = 0; i < json.size(); ++i) {
            places.push_back(json_path(where, i));
            SEAM_OK(read.add(json[i], places.back()));
        }
    } else if (json.is_object()) {
        table.names.push_back({PoseNames::Says::names, "", {}});
        for (const auto& [name, value] : json.items()) {
            places.push_back(where + ": " + csv::shown(name));
            SEAM_OK(read.add(value, places.back()));
            table.names.front().cells.push_back(name);
        }
    }
    if (read.size() == 0)
        return input_error("there are no poses", where, "give {\"NAME\": POSE, ..} or [POSE, ..]");
    SEAM_TRY(const auto poses, read.poses(where));
    for (std::size_t i = 0; i < poses.size(); ++i) table.poses.push_back({poses[i], places[i]});
    table.understood = read.understood();
    return table;
}

Expected<std::vector<Pose>> read_json_poses(std::span<const std::filesystem::path> files,
                                            const PoseLayout& layout) {
    JsonPoses read(layout);
    for (const auto& file : files) {
        const std::string where = file.string();
        SEAM_TRY(const auto text, read_text_file(file, std::size_t{1} << 20));
        SEAM_TRY(const auto json, parse_json(text, where));
        if (!json.is_object() || !json.contains("base_from_flange")) {
            SEAM_OK(read.add(json, where));
            continue;
        }
        for (const auto& [option, pose] : {std::pair{"--flange-from-tool", &layout.flange_from_tool},
                                           std::pair{"--base-from-user-frame", &layout.base_from_user_frame}})
            if (*pose)
                return input_error(Text("{} cannot act: the pose is called base_from_flange", option), where,
                                   Text("leave {} out, or give the pose without that name", option));
        SEAM_OK(read.add(json["base_from_flange"], where + ": base_from_flange"));
    }
    SEAM_TRY(auto poses,
             read.poses(files.size() == 1 ? files.front().string() : files.front().parent_path().string()));
    for (Pose& pose : poses) pose = brought_to_flange(pose, layout);
    return poses;
}

}  // namespace seamwright
