// Files of strangers through the real program: profiles, poses, units; and the data of every calibration that it
// writes itself.

#include <cmath>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "tests/app/import_case.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

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
    expect_refused(edge_job("b", {"--unit", "um"}), "--pose-convention");
    expect_refused(edge_job("b", {"--pose-convention", "fanuc-wpr"}), "--unit");
    EXPECT_EQ(answer(edge_job("b", {"--unit", "um", "--pose-convention", "fanuc-wpr"}), 0)["spots"], 8);
    expect_motion("b", 0.1);
    clear(folder);
    // ASC in inches, UR poses in metres.
    record([](const auto& p) { return "# x z\n" + rows_of(p, " ", 1 / 25.4); }, ".asc");
    poses("poses.txt", pose_rows("", ", ", false, [](const Pose& p) {
              const Eigen::Vector3d t = p.translation() / 1000, w = rotation_log(p.linear());
              return std::vector<double>{t.x(), t.y(), t.z(), w.x(), w.y(), w.z()};
          }));
    expect_refused(edge_job("c", {"--pose-convention", "ur-rotvec", "--pose-unit", "m"}), "inches");
    expect_refused(edge_job("c", {"--unit", "in", "--pose-convention", "ur-rotvec"}), "--pose-unit");
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

// The program alone, without the objects that stand beside it.
TEST_F(Import, WhatStandsBesideTheProgramIsAskedForInOneSentence) {
    const auto alone = folder / "alone" / "seamwright", images = folder / "images";
    std::filesystem::create_directories(alone.parent_path());
    std::filesystem::create_directories(images);
    std::filesystem::copy_file(SEAMWRIGHT_PROGRAM, alone);
    std::ofstream(images / "a.pgm") << "P5\n4 4\n255\n" << std::string(16, '7');
    const std::vector<std::string> look = {"import", "--look", "--from", images.string()};
    const ProgramResult r = run_program(look, folder, alone);
    EXPECT_EQ(r.exit_code, 1);
    EXPECT_THAT(r.out + r.err, HasSubstr("put seamwright_codecs.so beside the program"));
    EXPECT_THAT(run_program(look, folder).out, Not(HasSubstr("beside the program")));
    const auto step = folder / "a.step", stl = folder / "a.stl";
    std::ofstream(step) << "ISO-10303-21;\nEND-ISO-10303-21;\n";
    std::ofstream(stl)
        << "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 99 0 0\nvertex 0 99 0\n"
           "endloop\nendfacet\nendsolid a\n";
    for (const auto& [file, object] :
         {std::pair(step, "seamwright_shapes.so"), {stl, "seamwright_surfaces.so"}}) {
        const ProgramResult without = run_program({"drawing", file.string()}, folder, alone);
        EXPECT_EQ(without.exit_code, 3) << file;
        EXPECT_THAT(without.err, HasSubstr(std::string("put ") + object + " beside the program"));
        EXPECT_THAT(run_program({"drawing", file.string()}, folder).err,
                    Not(HasSubstr("beside the program")));
    }
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
    expect_refused(edge_job("a", {}), "scan_1.csv, line 253");
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
    expect_refused(job("t", {"--kind", "template", "--piece", "500,600", "--flange-from-sensor", flange}),
                   "--piece");
    expect_refused(edge_job("t", {"--piece", "-16,-1"}), "template");
}

// Spots as of an ordinary door with the defaults of import: the run is not refused for its sigma.
TEST_F(Import, DefaultSigmaAndLimitFitTogether) {
    record([](const auto& p) { return "x_mm,z_mm\n" + rows_of(p, ","); }, ".csv");
    poses("poses.csv", pose_rows("name,x,y,z,w,p,r\n", ",", true, xyz_wpr));
    const json made = answer(edge_job("door", {}), 0);
    EXPECT_THAT(made["notes"].dump(), HasSubstr("expected of a correction"));
    answer({"run", (folder / "door.seam").string()}, 0);
    expect_refused(edge_job("door", {"--sigma-mm", "0"}), "sigma");
    expect_refused(edge_job("door", {"--sigma-limit-mm", "-1"}), "sigma");
}

TEST_F(Import, EveryCalibrationSolvesItsOwnExample) {
    for (const std::string method : {"lens", "camera", "laser-plane", "lut", "tcp-sphere", "plate", "stereo",
                                     "bundle", "static", "hand-eye", "stripe-camera", "drift"}) {
        const std::string file = (folder / (method + ".json")).string();
        EXPECT_EQ(run({"calibrate", method, "--example", file}).exit_code, 0) << method;
        const json solved = answer({"calibrate", method, file}, 0);
        EXPECT_THAT(solved["verdict"].get<std::string>(), testing::AnyOf("good", "usable")) << method;
        EXPECT_THAT(run({"calibrate", method, "--help"}).out, HasSubstr("Layout of DATA.json")) << method;
        expect_refused({"calibrate", method}, "--example");
    }
    const ProgramResult fixed = run({"calibrate", "camera", (folder / "camera.json").string()});
    EXPECT_THAT(fixed.out, testing::Not(HasSubstr("± 0 ")));
    const ProgramResult plane = run({"calibrate", "stripe-camera", (folder / "stripe-camera.json").string()});
    EXPECT_THAT(plane.out, testing::Not(HasSubstr("± 0 ")));
    EXPECT_THAT(plane.out, HasSubstr("normal"));
}

}  // namespace
}  // namespace seamwright
