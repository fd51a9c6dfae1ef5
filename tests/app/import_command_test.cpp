// Files of strangers through the real program: profiles, poses, units, images, colour; and the data of every
// calibration that it writes itself.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <functional>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "core/geometry/pose.h"
#include "tests/app/run_program.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

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
const Pose kMoved = make_pose(rotation_exp({0.002, -0.001, 0.003}), {1.5, -2, 1});

class Import : public testing::Test {
  protected:
    std::filesystem::path folder = test_folder("import");
    ForeignCell cell;
    ~Import() override { std::filesystem::remove_all(folder); }

    std::string write(const std::string& name, const std::string& text) {
        std::filesystem::create_directories((folder / name).parent_path());
        std::ofstream(folder / name, std::ios::binary) << text;
        return (folder / name).string();
    }
    ProgramResult run(const std::vector<std::string>& arguments) { return run_program(arguments, folder); }
    json answer(std::vector<std::string> arguments, int exit_code) {
        arguments.insert(arguments.end(), {"--json", "-"});
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, exit_code) << r.err << r.out;
        return json::parse(r.out, nullptr, false);
    }
    void refused(const std::vector<std::string>& arguments, const std::string& words) {
        const ProgramResult r = run(arguments);
        EXPECT_EQ(r.exit_code, 2) << r.err << r.out;
        EXPECT_THAT(r.err, HasSubstr(words));
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
        EXPECT_EQ(r.out, "");
    }
    std::string pose_text(const Pose& p) const {
        json m = json::array();
        for (int r = 0; r < 4; ++r)
            for (int c = 0; c < 4; ++c) m.push_back(p.matrix()(r, c));
        return json{{"matrix", m}}.dump();
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
        const json r = answer({"run", (folder / (name + ".seam")).string()}, 0);
        ASSERT_TRUE(r.contains("regions")) << r.dump();
        const json& m = r["regions"][0]["correction"]["displacement"]["matrix"];
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

std::string rows_of(const ForeignCell::Points& points, const std::string& separator, double scale = 1,
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
void clear(const std::filesystem::path& folder) {
    for (const char* name : {"car", "master"}) std::filesystem::remove_all(folder / name);
}

TEST_F(Import, ForeignLayoutsInOneCommandEach) {
    const auto fanuc = [&] { return pose_rows("name;X;Y;Z;W;P;R\n", ";", true, xyz_wpr, true); };
    // Semicolons, decimal commas, a preamble; FANUC angles in a table by name.
    record(
        [](const auto& p) {
            return "Sensor;LMI 2340\nDate 2024\n\nX [mm];Z [mm]\n" + rows_of(p, ";", 1, true);
        },
        ".csv");
    poses("poses.csv", fanuc());
    EXPECT_EQ(answer(edge_job("a", {}), 0)["spots"], 8);
    expect_motion("a", 0.1);
    clear(folder);
    // Bare tabs in micrometres, six numbers by order.
    record([](const auto& p) { return rows_of(p, "\t", 1e3); }, ".txt");
    poses("poses.txt", pose_rows("", " ", false, xyz_wpr));
    refused(edge_job("b", {"--unit", "um"}), "--pose-convention");
    refused(edge_job("b", {"--pose-convention", "fanuc-wpr"}), "--unit");
    EXPECT_EQ(answer(edge_job("b", {"--unit", "um", "--pose-convention", "fanuc-wpr"}), 0)["spots"], 8);
    expect_motion("b", 0.1);
    clear(folder);
    // ASC in inches, UR poses in metres.
    record([](const auto& p) { return "# x z\n" + rows_of(p, " ", 1 / 25.4); }, ".asc");
    poses("poses.txt", pose_rows("", ", ", false, [](const Pose& p) {
              const Eigen::Vector3d t = p.translation() / 1000, w = rotation_log(p.linear());
              return std::vector<double>{t.x(), t.y(), t.z(), w.x(), w.y(), w.z()};
          }));
    refused(edge_job("c", {"--pose-convention", "ur-rotvec", "--pose-unit", "m"}), "inches");
    refused(edge_job("c", {"--unit", "in", "--pose-convention", "ur-rotvec"}), "--pose-unit");
    EXPECT_EQ(answer(edge_job("c", {"--unit", "in", "--pose-convention", "ur-rotvec", "--pose-unit", "m"}),
                     0)["spots"],
              8);
    expect_motion("c", 0.1);
    clear(folder);
    // PLY with 4x4 matrices beside every frame.
    record(
        [](const auto& p) {
            std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(p.size()) +
                               "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
            return text + rows_of(p, " 0 ");
        },
        ".ply");
    for (std::size_t i = 0; i < cell.places.size(); ++i) {
        std::ostringstream text;
        text << std::setprecision(12) << cell.places[i].base_from_flange.matrix() << "\n";
        poses("scan_" + std::to_string(i + 1) + ".txt", text.str());
    }
    EXPECT_EQ(answer(edge_job("d", {}), 0)["spots"], 8);
    expect_motion("d", 0.1);
    clear(folder);
    // One file for all profiles, poses of a FANUC program.
    std::string ls = "/PROG  SCAN\n/ATTR\n/MN\n/POS\n";
    for (std::size_t i = 0; i < cell.places.size(); ++i) {
        const auto n = xyz_wpr(cell.places[i].base_from_flange);
        char text[400];
        std::snprintf(
            text, sizeof text,
            "P[%zu]{\n   GP1:\n\tUF : 0, UT : 0,\t\tCONFIG : 'N U T, 0, 0, 0',\n\tX = %.6f  mm,\tY = %.6f  "
            "mm,\tZ = %.6f  mm,\n\tW = %.6f deg,\tP = %.6f deg,\tR = %.6f deg\n};\n",
            i + 1, n[0], n[1], n[2], n[3], n[4], n[5]);
        ls += text;
    }
    const std::string program = write("scan.ls", ls + "/END\n");
    for (const bool moved : {false, true}) {
        std::string text = "profile_index,x_mm,z_mm\n";
        for (std::size_t i = 0; i < cell.places.size(); ++i)
            for (const auto& p : cell.profile(cell.places[i], moved ? kMoved : Pose::Identity(),
                                              static_cast<unsigned>(i + (moved ? 100 : 0))))
                text +=
                    std::to_string(i + 1) + "," + std::to_string(p.x()) + "," + std::to_string(p.y()) + "\n";
        write(moved ? "car.csv" : "master.csv", text);
    }
    EXPECT_EQ(answer(edge_job("e", {"--poses", program}, "car.csv", "master.csv"), 0)["spots"], 8);
    expect_motion("e", 0.1);
}

TEST_F(Import, OurOwnExportsComeBackInEveryForm) {
    record([](const auto& p) { return "x_mm,z_mm\n" + rows_of(p, ","); }, ".csv");
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    answer(edge_job("first", {}), 0);
    expect_motion("first", 0.1);
    // The taught state as a run of its own.
    answer({"import", (folder / "taught.seam").string(), "--from", (folder / "master").string(),
            "--flange-from-sensor", pose_text(cell.flange_from_sensor), "--set", "side=right"},
           0);
    answer({"run", (folder / "taught.seam").string()}, 0);
    for (const std::string format : {"csv", "ply", "pcd"}) {
        clear(folder);
        if (format != "csv") poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
        answer({"export", (folder / "first.seam").string(), "--profiles", (folder / "car").string(),
                "--format", format},
               0);
        answer({"export", (folder / "taught.seam").string(), "--profiles", (folder / "master").string(),
                "--format", format},
               0);
        answer(edge_job("again", {}), 0);
        expect_motion("again", 0.1);
    }
}

// The program alone, without the object that stands beside it.
TEST_F(Import, WithoutItsCodecsAnImageIsRefusedInOneSentence) {
    const auto alone = folder / "alone" / "seamwright", images = folder / "images";
    std::filesystem::create_directories(alone.parent_path());
    std::filesystem::create_directories(images);
    std::filesystem::copy_file(SEAMWRIGHT_PROGRAM, alone);
    std::ofstream(images / "a.pgm") << "P5\n4 4\n255\n" << std::string(16, '7');
    const std::vector<std::string> look = {"import", "--look", "--from", images.string()};
    const ProgramResult r = run_program(look, folder, alone);
    EXPECT_EQ(r.exit_code, 1);
    EXPECT_THAT(r.out + r.err, HasSubstr("put seamwright_codecs.so beside the program"));
    EXPECT_THAT(run_program(look, folder).out, Not(HasSubstr("codecs")));
}

TEST_F(Import, LookSaysWhatWasUnderstood) {
    record([](const auto& p) { return "X;Z\n" + rows_of(p, ";", 1e3, true); }, ".csv");
    const std::string car = (folder / "car").string();
    json look = answer({"import", "--look", "--from", car}, 1);
    EXPECT_EQ(look["status"], "unclear");
    EXPECT_THAT(look["problem"].get<std::string>(), HasSubstr("has no pose"));
    EXPECT_EQ(look["files"][0]["suspected_unit"], "micrometres");
    EXPECT_THAT(look["files"][0]["understood"].get<std::string>(), HasSubstr("semicolons, decimal comma"));
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    look = answer({"import", "--look", "--from", car, "--unit", "um"}, 0);
    EXPECT_EQ(look["frames"], 8);
    EXPECT_NEAR(look["files"][0]["pitch"].get<double>(), 0.1, 0.01);
    EXPECT_NEAR(look["files"][0]["noise"].get<double>(), 0.02, 0.01);
    EXPECT_EQ(look["files"][0]["first"].size(), 3u);
    EXPECT_TRUE(look["files"][0]["base_from_flange"].is_object());
    const ProgramResult text = run({"import", "--look", "--from", car});
    EXPECT_THAT(text.out, HasSubstr("--unit"));
    EXPECT_FALSE(std::filesystem::exists(folder / "car.seam"));
}

TEST_F(Import, WhatStandsForNoReturnIsNoHeight) {
    record(
        [](const auto& p) {
            std::string text = "X;Z\n" + rows_of(p, ";");
            for (int i = 1; i < 40; ++i) text += std::to_string(50 + i) + ";-9999\n";
            return text;
        },
        ".csv");
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    const json look = answer({"import", "--look", "--from", (folder / "car").string()}, 0);
    EXPECT_EQ(look["files"][0]["suspected_unit"], "") << "the height -9999 is no contour of ten metres";
    EXPECT_THAT(look["files"][0]["no_returns"].dump(), HasSubstr("39 points stand at z = -9999"));
    const json made = answer(edge_job("n", {}), 0);
    EXPECT_THAT(made["notes"].dump(), HasSubstr("taken for lines without return"));
    EXPECT_THAT(made["understood"].dump(), HasSubstr("semicolons"));
    expect_motion("n", 0.1);
}

TEST_F(Import, TheFirstErrorNamesFileAndLine) {
    record([](const auto& p) { return "x;z\n" + rows_of(p, ";") + "1.5;abc\n"; }, ".csv");
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    refused(edge_job("a", {}), "scan_1.csv, line 253");
    EXPECT_EQ(
        run({"import", (folder / "a.seam").string(), "--from", (folder / "nowhere.csv").string()}).exit_code,
        3);
    EXPECT_EQ(run({"import", "--from", (folder / "car").string()}).exit_code, 2) << "no project named";
    for (const std::string& bytes : {std::string(), std::string("\x93NUMPY"), std::string(5000, '\0'),
                                     std::string("ply\nformat ascii 1.0\n"), std::string("x;z\nnan;nan\n"),
                                     std::string("x;z\n1e300;1e300\n2;3\n")}) {
        write("one/scan.csv", bytes);
        write("one/scan.json", "{\"xyz\":[800,0,0],\"abc\":[0,0,0]}");
        const ProgramResult r =
            run({"import", (folder / "h.seam").string(), "--from", (folder / "one").string()});
        EXPECT_EQ(r.exit_code, 2) << r.err;
        EXPECT_EQ(std::count(r.err.begin(), r.err.end(), '\n'), 1) << r.err;
    }
}

// A bent contour, taught from the master and found again, as a whole and as a piece.
TEST_F(Import, TemplatesAreTaughtFromTheMaster) {
    const auto bent = [&](const ForeignCell::Place& place, const Pose& moved, unsigned seed) {
        auto points = cell.profile(place, moved, seed);
        // The sheet's last 8 mm are folded down by 40 degrees.
        const auto [end, into] = cell.cut(place, moved);
        const Eigen::Vector2d fold = end + 8 * into, turned = Eigen::Rotation2Dd(-rad_from_deg(40)) * -into;
        for (auto& p : points) {
            const double beyond = (fold - p).dot(into);
            if (beyond > 0) p += beyond * (turned + into);
        }
        return points;
    };
    for (const bool moved : {false, true})
        for (std::size_t i = 0; i < cell.places.size(); ++i)
            write((moved ? "car/scan_" : "master/scan_") + std::to_string(i + 1) + ".csv",
                  "x,z\n" + rows_of(bent(cell.places[i], moved ? kMoved : Pose::Identity(),
                                         static_cast<unsigned>(i + (moved ? 100 : 0))),
                                    ","));
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    const std::string flange = pose_text(cell.flange_from_sensor);
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{}, {"--piece", "-16,-1", "--landmark", "-8,0"}}) {
        std::vector<std::string> a{"--kind", "template", "--flange-from-sensor", flange};
        a.insert(a.end(), more.begin(), more.end());
        EXPECT_EQ(answer(job("t", a), 0)["spots"], 8);
        expect_motion("t", 0.1);
    }
    refused(job("t", {"--kind", "template", "--piece", "500,600", "--flange-from-sensor", flange}),
            "--piece");
    refused(edge_job("t", {"--piece", "-16,-1"}), "template");
}

// Spots as of an ordinary door with the defaults of import: the run is not refused for its sigma.
TEST_F(Import, DefaultSigmaAndLimitFitTogether) {
    record([](const auto& p) { return "x_mm,z_mm\n" + rows_of(p, ","); }, ".csv");
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    const json made = answer(edge_job("door", {}), 0);
    EXPECT_THAT(made["notes"].dump(), HasSubstr("expected of a correction"));
    answer({"run", (folder / "door.seam").string()}, 0);
    refused(edge_job("door", {"--sigma-mm", "0"}), "sigma");
    refused(edge_job("door", {"--sigma-limit-mm", "-1"}), "sigma");
}

// --- images

// A camera 250 mm above the work, the laser plane at 30 degrees to its sight; by the textbook's pinhole.
constexpr int kImageWidth = 640, kImageHeight = 480;
constexpr double kFocal = 900;
Pose camera_from_laser() {
    const double c = std::cos(kPi / 6), s = std::sin(kPi / 6);
    Eigen::Matrix3d r;
    r << 1, 0, 0, 0, -c, s, 0, -s, -c;
    return make_pose(r, {0, 0, 250});
}
std::string stripe_image(const Eigen::Vector2d& end, const Eigen::Vector2d& into) {
    std::vector<double> grey(kImageWidth * kImageHeight, 4);
    const auto pixel = [&](double s) {
        const Eigen::Vector2d p = end + s * into;
        const Eigen::Vector3d c = camera_from_laser() * Eigen::Vector3d(p.x(), 0, p.y());
        return Eigen::Vector2d(kFocal * c.x() / c.z() + 320, kFocal * c.y() / c.z() + 240);
    };
    for (double s = 0; s < 40; s += 0.02) {
        const Eigen::Vector2d p = pixel(s);
        const int column = static_cast<int>(std::lround(p.x()));
        for (int row = static_cast<int>(p.y()) - 6; row <= static_cast<int>(p.y()) + 6; ++row)
            if (column >= 0 && row >= 0 && column < kImageWidth && row < kImageHeight)
                grey[static_cast<std::size_t>(row * kImageWidth + column)] +=
                    12 * std::exp(-0.5 * std::pow((row - p.y()) / 1.6, 2));
    }
    std::string image = "P5\n640 480\n255\n";
    for (const double g : grey) image += static_cast<char>(static_cast<unsigned char>(std::min(250.0, g)));
    return image;
}

TEST_F(Import, ImagesBecomeMillimetresByAStoredCalibrationAndPixelsAreNotRetaught) {
    for (const bool moved : {false, true})
        for (std::size_t i = 0; i < cell.places.size(); ++i) {
            const auto [end, into] = cell.cut(cell.places[i], moved ? kMoved : Pose::Identity());
            write((moved ? "car/scan_" : "master/scan_") + std::to_string(i + 1) + ".pgm",
                  stripe_image(end, into));
        }
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    const json laser = json::parse(pose_text(camera_from_laser()));
    json solved{{"method", "stripe-camera"},
                {"verdict", "good"},
                {"camera",
                 {{"fx", kFocal}, {"fy", kFocal}, {"cx", 320}, {"cy", 240}, {"width", 640}, {"height", 480}}},
                {"camera_from_laser", laser},
                {"hand_eye",
                 {{"flange_from_camera",
                   json::parse(pose_text(cell.flange_from_sensor * camera_from_laser().inverse()))}}}};
    const std::string calibration = write("solved.json", solved.dump());
    const json made = answer(
        job("mm", {"--calibration", calibration, "--set", "side=right", "--sigma-limit-mm", "0.4"}), 0);
    EXPECT_EQ(made["in_pixels"], false);
    expect_motion("mm", 0.4);  // a pixel is 0.28 mm

    // The stored one of that project does as well, for further recordings.
    answer(job("mm2", {"--calibration", (folder / "mm.seam").string(), "--set", "side=right",
                       "--sigma-limit-mm", "0.4"}),
           0);
    expect_motion("mm2", 0.4);

    // What the command line led to before: pixels, a calibration stored beside them, and reteach.
    const std::string pixels = (folder / "px.seam").string(), example = (folder / "example.json").string();
    EXPECT_EQ(answer(job("px", {"--set", "side=right", "--set", "fit_length_mm=60"}), 0)["in_pixels"], true);
    EXPECT_EQ(run({"calibrate", "stripe-camera", "--example", example}).exit_code, 0);
    const json stored =
        answer({"calibrate", "stripe-camera", example, "--store", pixels, "--sensor", "A"}, 0);
    const std::string id = stored["stored_as"];
    const json before = answer({"info", pixels}, 0)["project"];
    refused({"reteach", pixels, "--sensor", "A", "--calibration", id}, "taught in pixels");
    EXPECT_EQ(answer({"info", pixels}, 0)["project"], before);
    // It is offered for the import, and refused for images of another camera.
    refused(job("no", {"--calibration", pixels, "--set", "side=right"}), "1280 x 1024");
    refused(job("no", {"--calibration", pixels, "--calibration-id", "none"}), id);
    refused(job("no", {"--calibration", pixels, "--calibration-id", "import"}), "pixels");
    solved.erase("hand_eye");
    solved["hand_eye"] = nullptr;
    // Its laser plane alone does not say where the camera sits.
    refused(job("no", {"--calibration", write("half.json", solved.dump()), "--set", "side=right"}),
            "--flange-from-sensor");
    refused(job("no", {"--calibration", write("text.json", "[1,2]")}), "text.json");

    // A table of the same camera, as `calibrate lut` writes it.
    json pairs = json::array();
    const Pose laser_from_camera = camera_from_laser().inverse();
    for (int u = 5; u < 640; u += 21)
        for (int v = 5; v < 480; v += 21) {
            const Eigen::Vector3d ray =
                laser_from_camera.linear() * Eigen::Vector3d((u - 320) / kFocal, (v - 240) / kFocal, 1);
            const Eigen::Vector3d from = laser_from_camera.translation();
            const double far = -from.y() / ray.y();
            if (far > 0)
                pairs.push_back(
                    {{"pixel", {u, v}}, {"laser", {from.x() + far * ray.x(), from.z() + far * ray.z()}}});
        }
    const std::string table = (folder / "camera.lut").string();
    const std::string data = write("pairs.json", json{{"size", {640, 480}}, {"pairs", pairs}}.dump());
    answer({"calibrate", "lut", data, "--table", table}, 0);
    EXPECT_EQ(answer(job("table",
                         {"--calibration", table, "--flange-from-sensor", pose_text(cell.flange_from_sensor),
                          "--set", "side=right", "--sigma-limit-mm", "0.4"}),
                     0)["in_pixels"],
              false);
    expect_motion("table", 0.4);
    refused(job("no", {"--calibration", table, "--set", "side=right"}), "--flange-from-sensor");
    refused(job("no", {"--calibration", write("text.lut", "no table")}), "text.lut");
}

// A red line on a colour camera under white light, beside a bright white reflection.
TEST_F(Import, TheLaserIsReadInItsColour) {
    constexpr int kWidth = 480, kHeight = 320;
    const auto row_of_laser = [](int column) { return 200 + 0.05 * column; };
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0, 2);
    const auto picture = [&](bool laser) {
        std::string image = "P6\n480 320\n255\n";
        for (int r = 0; r < kHeight; ++r)
            for (int c = 0; c < kWidth; ++c) {
                const double white =
                    60 + 140 * std::exp(-0.5 * std::pow((r - 80.0) / 2.5, 2)) + noise(random);
                const double red = laser ? 70 * std::exp(-0.5 * std::pow((r - row_of_laser(c)) / 1.8, 2)) : 0;
                for (const double v : {white + red, white, white})
                    image += static_cast<char>(static_cast<unsigned char>(std::clamp(v, 0.0, 255.0)));
            }
        return image;
    };
    const std::string on = write("on.ppm", picture(true)), off = write("off.ppm", picture(false));
    const std::string out = (folder / "peaks.csv").string();
    const auto right = [&] {
        std::istringstream text(slurp(out));
        std::string line;
        int count = 0;
        std::getline(text, line);
        while (std::getline(text, line)) {
            int column = 0, peak = 0;
            double position = 0, grey = 0, width = 0;
            if (std::sscanf(line.c_str(), "%d,%lf,%lf,%lf,%d", &column, &position, &grey, &width, &peak) ==
                    5 &&
                peak == 0 && std::abs(position - row_of_laser(column)) < 0.6)
                ++count;
        }
        return count / static_cast<double>(kWidth);
    };
    json r = answer({"extract", on, "--columns", "--out", out}, 0);
    EXPECT_EQ(r["channel"], "red-difference");
    EXPECT_EQ(r["colour"], true);
    EXPECT_GE(right(), 0.99);
    r = answer({"extract", on, "--columns", "--channel", "grey", "--out", out}, 0);
    EXPECT_LE(right(), 0.01) << "in grey the reflection is the stronger line";
    EXPECT_THAT(r["warnings"].dump(), HasSubstr("folded to grey"));
    r = answer({"extract", on, "--columns", "--channel", "grey", "--laser-off", off, "--out", out}, 0);
    EXPECT_GE(right(), 0.99);
    refused({"extract", on, "--laser-off", write("small.ppm", "P6\n2 2\n255\nabcabcabcabc"), "--out", out},
            "no pair");
    EXPECT_EQ(run({"extract", on, "--channel", "infrared", "--out", out}).exit_code, 2);
}

TEST_F(Import, EveryCalibrationSolvesItsOwnExample) {
    for (const std::string method : {"lens", "camera", "laser-plane", "lut", "tcp-sphere", "plate", "stereo",
                                     "bundle", "static", "hand-eye", "stripe-camera", "drift"}) {
        const std::string file = (folder / (method + ".json")).string();
        EXPECT_EQ(run({"calibrate", method, "--example", file}).exit_code, 0) << method;
        const json solved = answer({"calibrate", method, file}, 0);
        EXPECT_THAT(solved["verdict"].get<std::string>(), testing::AnyOf("good", "usable")) << method;
        EXPECT_THAT(run({"calibrate", method, "--help"}).out, HasSubstr("Layout of DATA.json")) << method;
        refused({"calibrate", method}, "--example");
    }
    const ProgramResult fixed = run({"calibrate", "camera", (folder / "camera.json").string()});
    EXPECT_THAT(fixed.out, testing::Not(HasSubstr("± 0 ")));
    const ProgramResult plane = run({"calibrate", "stripe-camera", (folder / "stripe-camera.json").string()});
    EXPECT_THAT(plane.out, testing::Not(HasSubstr("± 0 ")));
    EXPECT_THAT(plane.out, HasSubstr("normal"));
}

}  // namespace
}  // namespace seamwright
