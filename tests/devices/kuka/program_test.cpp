// The generated KRL, read by a small reader of its own.

#include "devices/kuka/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "core/geometry/pose.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

ProgramRequest request(int spots = 3) {
    ProgramRequest r;
    r.project = "door left";
    for (int i = 1; i <= spots; ++i) {
        MeasuringMove m;
        m.spot_id = "S" + std::to_string(i);
        m.trigger = make_pose(rotation_exp({0.3 * i, -0.5, 1.1}), {1000.1234 + i, -250.5, 700});
        m.entry = m.exit = m.trigger;
        m.entry.translation().x() -= 20;
        m.exit.translation().x() += 20;
        m.speed_mm_s = 100;
        m.stop_at_trigger = i == 2;
        r.moves.push_back(m);
    }
    r.frames = {{"left", "BASE_left", make_pose(rotation_exp({0.1, 0.2, 0.3}), {900, -450, 500})}};
    r.settings = {{"listen", "192.168.1.20"}, {"port", 54601}};
    return r;
}

std::map<std::string, std::string> files_of(const ProgramRequest& r) {
    auto files = write_kuka_program(r);
    EXPECT_TRUE(files) << files.error().sentence();
    std::map<std::string, std::string> by_name;
    for (const ProgramFile& f : *files) by_name[f.name] = f.text;
    return by_name;
}

// {X 1,Y 2,Z 3,A 4,B 5,C 6} by rotations written out.
Pose frame_of(const std::string& text) {
    double v[6];
    EXPECT_EQ(std::sscanf(text.c_str(), "{X %lf,Y %lf,Z %lf,A %lf,B %lf,C %lf}", v, v + 1, v + 2, v + 3,
                          v + 4, v + 5),
              6)
        << text;
    const double d = kPi / 180;
    return make_pose((Eigen::AngleAxisd(v[3] * d, Eigen::Vector3d::UnitZ()) *
                      Eigen::AngleAxisd(v[4] * d, Eigen::Vector3d::UnitY()) *
                      Eigen::AngleAxisd(v[5] * d, Eigen::Vector3d::UnitX()))
                         .toRotationMatrix(),
                     {v[0], v[1], v[2]});
}

TEST(KukaProgram, HoldsTheProjectsPoses) {
    const ProgramRequest r = request();
    auto files = files_of(r);
    std::map<std::string, Pose> points;
    const std::regex declared(R"(DECL FRAME (\w+)=(\{[^}]*\}))");
    const std::string& data = files["seamwright_spots.dat"];
    for (std::sregex_iterator it(data.begin(), data.end(), declared), end; it != end; ++it)
        EXPECT_TRUE(points.emplace((*it)[1], frame_of((*it)[2])).second) << "declared twice";
    ASSERT_EQ(points.size(), 9u);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string name = "XSW_00" + std::to_string(i + 1);
        for (const auto& [suffix, pose] : {std::pair{"_ENTRY", r.moves[i].entry},
                                           {"_SPOT", r.moves[i].trigger},
                                           {"_EXIT", r.moves[i].exit}}) {
            EXPECT_LT(distance_mm(points.at(name + suffix), pose), 1e-3);
            EXPECT_LT(deg_from_rad(angle_rad(points.at(name + suffix), pose)), 1e-4);
        }
    }
    const std::string& program = files["seamwright_spots.src"];
    std::smatch frame;
    ASSERT_TRUE(std::regex_search(program, frame, std::regex(R"(SW_FRAME\[1\]=(\{[^}]*\}))")));
    EXPECT_LT(distance_mm(frame_of(frame[1]), r.frames[0].base_from_frame), 1e-3);
    EXPECT_THAT(program, HasSubstr(program_signature(r.moves)));
    // Every point that a motion goes to is declared; metres a second.
    const std::regex used(R"(\bXSW_\w+)");
    for (std::sregex_iterator it(program.begin(), program.end(), used), end; it != end; ++it)
        EXPECT_TRUE(points.count(it->str())) << it->str();
    EXPECT_THAT(program, HasSubstr("$VEL.CP=0.1000\n"));
}

// A region whose spots are disabled leaves its number to nobody.
TEST(KukaProgram, FramesKeepTheirNumbersAndHaveConstants) {
    ProgramRequest r = request();
    r.frames = {{"top", "BASE_top", Pose::Identity(), 2}, {"hinge", "BASE_hinge", Pose::Identity(), 4}};
    const auto files = files_of(r);
    const std::string &program = files.at("seamwright_spots.src"), &data = files.at("seamwright_spots.dat");
    for (const char* line : {"SW_NAME[1,]=\"-\"\n", "SW_NAME[2,]=\"BASE_top\"\n", "SW_NAME[3,]=\"-\"\n",
                             "SW_NAME[4,]=\"BASE_hinge\"\n", "SW_FRAMES=4\n",
                             "; region hinge: SW_ACTIVATE(SW_BASE_hinge) before its path\n"})
        EXPECT_THAT(program, HasSubstr(line));
    EXPECT_THAT(data, HasSubstr("DECL GLOBAL CONST INT SW_BASE_top=2\n"));
    EXPECT_THAT(data, HasSubstr("DECL GLOBAL CONST INT SW_BASE_hinge=4\n"));
    r.frames[0].number = 33;
    EXPECT_THAT(write_kuka_program(r).error().sentence(), HasSubstr("33 frames"));
}

TEST(KukaProgram, EveryConstantIsANameOfItsOwn) {
    ProgramRequest r = request();
    r.frames.clear();
    const std::string longest(60, 'x');
    for (const std::string& name :
         {std::string("frame"), std::string("FRAMES"), std::string("travel"), longest, longest + "y",
          std::string("a b"), std::string("a-b"), std::string("A_B"), std::string("setup")})
        r.frames.push_back({"region", name, Pose::Identity()});
    const auto files = files_of(r);
    const std::string& data = files.at("seamwright_spots.dat");
    std::string module;
    for (const auto& [file, text] : files)
        if (file != "seamwright_spots.dat") module += text;
    const std::regex declared(R"(DECL GLOBAL CONST INT (\w+)=(\d+))");
    std::set<std::string> names;
    for (std::sregex_iterator it(data.begin(), data.end(), declared), end; it != end; ++it) {
        std::string name = (*it)[1];
        EXPECT_LE(name.size(), 24u);
        EXPECT_FALSE(std::regex_search(std::regex_replace(module, std::regex(";[^\n]*"), ""),
                                       std::regex("\\b" + name + "\\b", std::regex::icase)))
            << name;
        for (char& c : name) c = static_cast<char>(std::toupper(c));
        EXPECT_TRUE(names.insert(name).second) << name;
    }
    EXPECT_EQ(names.size(), r.frames.size());
}

TEST(KukaProgram, EveryFileIsBalancedKrl) {
    for (auto& [name, text] : files_of(request())) {
        EXPECT_FALSE(std::regex_search(text, std::regex("@[A-Z_]+@")))
            << name << ": every value is filled in";
        if (name.ends_with(".xml")) {
            EXPECT_THAT(text, HasSubstr("<IP>192.168.1.20</IP>"));
            EXPECT_THAT(text, HasSubstr("<PORT>54601</PORT>"));
            continue;
        }
        std::map<std::string, int> count;
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            EXPECT_LE(line.size(), 255u) << name;
            std::string word = line.substr(std::min(line.find_first_not_of(' '), line.size()));
            if (word.starts_with(";") || word.starts_with("&")) continue;
            if (word.starts_with("GLOBAL DEF ")) word = word.substr(7);
            word = word.substr(0, word.find_first_of(" ("));
            ++count[word];
        }
        EXPECT_EQ(count["DEF"], count["END"]) << name;
        EXPECT_EQ(count["DEFDAT"], count["ENDDAT"]) << name;
        EXPECT_EQ(count["IF"], count["ENDIF"]) << name;
        EXPECT_EQ(count["FOR"], count["ENDFOR"]) << name;
        EXPECT_EQ(count["LOOP"], count["ENDLOOP"]) << name;
        EXPECT_EQ(count["SWITCH"], count["ENDSWITCH"]) << name;
    }
}

TEST(KukaProgram, RefusesWhatTheModuleCannotHold) {
    const auto refused = [](ProgramRequest r, const std::string& word) {
        auto files = write_kuka_program(r);
        ASSERT_FALSE(files);
        EXPECT_EQ(files.error().kind, ErrorKind::input);
        EXPECT_THAT(files.error().sentence(), HasSubstr(word));
    };
    refused(request(65), "65 spots");
    ProgramRequest r = request();
    r.moves[1].spot_id = "S\"2";
    refused(r, "cannot be written in KRL");
    r = request();
    r.moves[1].spot_id = std::string(80, 'S');
    refused(r, "cannot be written in KRL");
    r = request();
    r.frames[0].name = "größe";
    refused(r, "cannot be written in KRL");
    r = request();
    r.moves[0].speed_mm_s = 2500;
    refused(r, "no speed");
    r = request();
    r.moves[0].speed_mm_s = std::nan("");
    refused(r, "no speed");
    r = request();
    r.moves[2].exit.translation().x() = std::numeric_limits<double>::infinity();
    refused(r, "not finite");
}

TEST(KukaProgram, ViaPointsArePassedBeforeTheEntryAtTravellingSpeed) {
    ProgramRequest r = request();
    const std::string before = program_signature(r.moves);
    r.moves[1].via = {make_pose(rotation_exp({0, 0, 1}), {1000, 10, 900}),
                      make_pose(rotation_exp({0, 0, 2}), {1001, 20, 900})};
    EXPECT_NE(program_signature(r.moves), before);
    auto files = files_of(r);
    EXPECT_THAT(
        files["seamwright_spots.src"],
        HasSubstr(
            "$VEL.CP=SW_TRAVEL\nLIN XSW_002_VIA1 C_DIS\nLIN XSW_002_VIA2 C_DIS\nLIN XSW_002_ENTRY C_DIS\n"));
    EXPECT_THAT(files["seamwright_spots.dat"], HasSubstr("DECL FRAME XSW_002_VIA2={X 1001.0000,Y 20.0000,"));
    r.moves[1].via[0].translation().x() = std::nan("");
    EXPECT_FALSE(write_kuka_program(r));
}

TEST(KukaProgram, NamesAndAddressesCannotChangeTheFiles) {
    ProgramRequest r = request();
    r.project = "door\nHALT";
    r.frames[0].region_id = "left\nHALT";
    auto files = files_of(r);
    EXPECT_EQ(files["seamwright_spots.src"].find("\nHALT"), std::string::npos);
    for (const char* listen : {"", "0.0.0.0", "1.2.3.4</IP><IP>5.6.7.8", "my-computer"}) {
        r.settings["listen"] = listen;
        EXPECT_FALSE(write_kuka_program(r)) << listen;
    }
}

TEST(PathProgram, IsNotNamedByAWordOfALanguageOrOfOurModules) {
    PathProgramRequest r;
    r.frame_from_tool = {Pose::Identity()};
    EXPECT_TRUE(write_kuka_path(r));
    for (const char* name : {"while", "END", "to", "return", "Pos", "robtarget", "def", "thread", "elif",
                             "MoveL", "SEAMWRIGHT", "sw_fire"}) {
        r.name = name;
        auto files = write_kuka_path(r);
        ASSERT_FALSE(files) << name;
        EXPECT_THAT(files.error().sentence(), HasSubstr(name));
        EXPECT_EQ(files.error().kind, ErrorKind::input);
    }
}

TEST(ProgramSignature, TellsProgramsApart) {
    const auto moves = request().moves;
    const std::string signature = program_signature(moves);
    EXPECT_TRUE(std::regex_match(signature, std::regex("SW-[0-9A-F]{16}")));
    EXPECT_EQ(signature, program_signature(moves));
    std::set<std::string> others = {signature};
    auto m = moves;
    std::swap(m[0], m[1]);
    EXPECT_TRUE(others.insert(program_signature(m)).second);
    m = moves;
    m[0].spot_id = "S1 ";
    EXPECT_TRUE(others.insert(program_signature(m)).second);
    m = moves;
    m[2].exit.translation().z() += 0.01;
    EXPECT_TRUE(others.insert(program_signature(m)).second);
    m.pop_back();
    EXPECT_TRUE(others.insert(program_signature(m)).second);
    m = moves;
    m[0].stop_at_trigger = true;  // an old program would pass over the spot
    EXPECT_TRUE(others.insert(program_signature(m)).second);
    m = moves;
    m[0].speed_mm_s += 0.1;
    EXPECT_TRUE(others.insert(program_signature(m)).second);
    m[0].speed_mm_s = moves[0].speed_mm_s + 1e-6;
    EXPECT_EQ(program_signature(m), signature);
    for (const NumberedFrame& frame :
         {NumberedFrame{1, "BASE_left"}, {2, "BASE_left"}, {1, "BASE_right"}, {2, "BASE_right"}}) {
        m = moves;
        m[0].frames = {frame};
        EXPECT_TRUE(others.insert(program_signature(m)).second) << frame.number << frame.name;
    }
    m = moves;
    for (auto& move : m) move.trigger.translation().x() += 1e-7;  // rounding of a file is no other program
    EXPECT_EQ(program_signature(m), signature);
}

}  // namespace
}  // namespace seamwright
