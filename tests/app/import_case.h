#pragma once
// A stranger's cell as files, imported by the real program.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "core/geometry/pose.h"
#include "tests/app/cli_case.h"

namespace seamwright {

// Eight spots around the rim of a part some 900 mm before the robot, two on each of its four sides. At each
// the sheet ends in a straight edge that runs nearly along the sensor's Y; the sensor sees the sheet and its
// end. Everything follows from that geometry.
struct ForeignCell {
    struct Place {
        Pose base_from_flange;
        Eigen::Vector3d edge, along, normal;  // of the sheet at the spot, base; unmoved
    };
    std::vector<Place> places;
    Pose flange_from_sensor = make_pose(rotation_exp({0.05, -0.1, 0.3}), {20, -15, 120});

    ForeignCell() {
        for (int i = 0; i < 8; ++i) {
            const double a = kPi / 2 * (i / 2), shift = i % 2 == 0 ? -180 : 210;
            const Eigen::Vector3d out(std::cos(a), std::sin(a), 0), beside(-out.y(), out.x(), 0);
            const Eigen::Vector3d edge = Eigen::Vector3d(900, 0, 300 + 25.0 * (i % 3)) +
                                         (i / 2 % 2 == 0 ? 400 : 300) * out + shift * beside;
            const Eigen::Vector3d normal =
                (Eigen::Vector3d::UnitZ() + 0.3 * ((i % 2) ? 1 : -1) * out).normalized();
            Eigen::Matrix3d sensor;  // x out over the edge, z along the normal
            sensor.col(2) = normal;
            sensor.col(0) = (out - normal * normal.dot(out)).normalized();
            sensor.col(1) = sensor.col(2).cross(sensor.col(0));
            const Pose base_from_sensor = make_pose(sensor, edge);
            places.push_back({base_from_sensor * flange_from_sensor.inverse(), edge,
                              base_from_sensor.linear().col(1), normal});
        }
    }
    // Where the moved sheet is cut by the sensor's plane: its end, and the direction into the sheet; (x, z).
    std::pair<Eigen::Vector2d, Eigen::Vector2d> cut(const Place& p, const Pose& moved) const {
        const Pose sensor_from_base = (p.base_from_flange * flange_from_sensor).inverse();
        const Eigen::Vector3d edge = sensor_from_base * (moved * p.edge);
        const Eigen::Vector3d along = sensor_from_base.linear() * (moved.linear() * p.along);
        const Eigen::Vector3d normal = sensor_from_base.linear() * (moved.linear() * p.normal);
        const Eigen::Vector3d end = edge - along * (edge.y() / along.y());
        Eigen::Vector3d into = Eigen::Vector3d::UnitY().cross(normal);
        if (into.x() > 0) into = -into;
        into.normalize();
        return {{end.x(), end.z()}, {into.x(), into.z()}};
    }
    using Points = std::vector<Eigen::Vector2d>;
    Points profile(const Place& p, const Pose& moved, unsigned seed) const {
        std::mt19937 random(seed);
        std::normal_distribution<double> noise(0, 0.02);
        const auto [end, into] = cut(p, moved);
        Points points;
        for (int i = 250; i >= 0; --i) {
            const Eigen::Vector2d at = end + 0.1 * i * into;
            points.emplace_back(at.x(), at.y() + noise(random));
        }
        return points;
    }
};
inline const Pose kMoved = make_pose(rotation_exp({0.002, -0.001, 0.003}), {1.5, -2, 1});

class Import : public CliCase {
  protected:
    ForeignCell cell;

    std::string pose_text(const Pose& p) const {
        nlohmann::json m = nlohmann::json::array();
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c) m.push_back(p.matrix()(r, c));
        return nlohmann::json{{"matrix", m}}.dump();
    }
    std::vector<std::string> job(const std::string& name, const std::vector<std::string>& more,
                                 const std::string& from = "car", const std::string& reference = "master") {
        std::vector<std::string> a{
            "import",      (folder / (name + ".seam")).string(), "--from",   (folder / from).string(),
            "--reference", (folder / reference).string(),        "--replace"};
        a.insert(a.end(), more.begin(), more.end());
        return a;
    }
    std::vector<std::string> edge_job(const std::string& name, std::vector<std::string> more,
                                      const std::string& from = "car",
                                      const std::string& reference = "master") {
        more.insert(more.end(),
                    {"--flange-from-sensor", pose_text(cell.flange_from_sensor), "--set", "side=right"});
        return job(name, more, from, reference);
    }
    // The part's motion comes out of a run of the imported project, and the run is sound.
    void expect_motion(const std::string& name, double within_mm) {
        const nlohmann::json r = answer({"run", (folder / (name + ".seam")).string()}, 0);
        ASSERT_TRUE(r.contains("regions")) << r.dump();
        const nlohmann::json& m = r["regions"][0]["correction"]["displacement"]["matrix"];
        ASSERT_TRUE(m.is_array()) << r.dump(1);
        Pose found = Pose::Identity();
        for (int i = 0; i < 3; ++i)
            for (int k = 0; k < 4; ++k)
                found.matrix()(i, k) =
                    m[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)].get<double>();
        for (const auto& place : cell.places)
            EXPECT_LT((found * place.edge - kMoved * place.edge).norm(), within_mm) << name;
    }
    // Both states as files: `file` makes the text of one profile, `poses` goes beside.
    void record(const std::function<std::string(const ForeignCell::Points&)>& file,
                const std::string& extension) {
        for (const bool moved : {false, true})
            for (std::size_t i = 0; i < cell.places.size(); ++i)
                write((moved ? "car/scan_" : "master/scan_") + std::to_string(i + 1) + extension,
                      file(cell.profile(cell.places[i], moved ? kMoved : Pose::Identity(),
                                        static_cast<unsigned>(i + (moved ? 100 : 0)))));
    }
    void poses(const std::string& name, const std::string& text) {
        write("car/" + name, text);
        write("master/" + name, text);
    }
    // Angles about x, y, z of R = Rz Ry Rx, degrees.
    static Eigen::Vector3d rpy(const Pose& p) {
        const Eigen::Matrix3d r = p.linear();
        return Eigen::Vector3d(std::atan2(r(2, 1), r(2, 2)), -std::asin(r(2, 0)),
                               std::atan2(r(1, 0), r(0, 0))) *
               (180 / kPi);
    }
    std::string pose_rows(const std::string& header, const std::string& separator, bool named,
                          const std::function<std::vector<double>(const Pose&)>& numbers,
                          bool decimal_comma = false) {
        std::string text = header;
        for (std::size_t i = 0; i < cell.places.size(); ++i) {
            std::string row = named ? "scan_" + std::to_string(i + 1) : "";
            for (const double v : numbers(cell.places[i].base_from_flange)) {
                char digits[32];
                std::snprintf(digits, sizeof digits, "%.9f", v);
                std::string s = digits;
                if (decimal_comma) std::replace(s.begin(), s.end(), '.', ',');
                row += (row.empty() ? "" : separator) + s;
            }
            text += row + "\n";
        }
        return text;
    }
    static std::vector<double> xyz_wpr(const Pose& p) {
        const Eigen::Vector3d t = p.translation(), a = rpy(p);
        return {t.x(), t.y(), t.z(), a.x(), a.y(), a.z()};
    }
};

inline std::string rows_of(const ForeignCell::Points& points, const std::string& separator, double scale = 1,
                           bool comma = false) {
    std::string text;
    for (const auto& p : points) {
        char row[96];
        std::snprintf(row, sizeof row, "%.7f%s%.7f\n", p.x() * scale, separator.c_str(), p.y() * scale);
        std::string s = row;
        if (comma) std::replace(s.begin(), s.end(), '.', ',');
        text += s;
    }
    return text;
}
inline void clear(const std::filesystem::path& folder) {
    for (const char* name : {"car", "master"}) std::filesystem::remove_all(folder / name);
}

}  // namespace seamwright
