// Every convention, cell after cell and at several levels of noise: named rightly or "cannot tell", never wrongly.

#include <cstdio>
#include <functional>
#include <map>

#include "tests/projects/calibrate/convention_cell.h"

namespace seamwright {
namespace {

using namespace elsewhere;
using simulation::any_cell;
using simulation::Random;
using simulation::SphereCell;

struct Tally {
    int asked = 0, named = 0, cannot_tell = 0, wrong = 0;
    void count(const ConventionAnswer& answer, const char* list, const std::string& code) {
        ++asked;
        const std::string verdict = answer.result.value("verdict", "");
        if (verdict == "cannot_tell")
            ++cannot_tell;
        else if (verdict == "named" && answer.offer.size() == 1 && answer.offer.value(list, "") == code)
            ++named;
        else if (!(verdict == "as_given" && code == Writing{}.code()))
            ++wrong;
        else
            ++named;
    }
};

std::vector<Writing> writings() {
    std::vector<Writing> all;
    for (const bool fixed : {false, true})
        for (const auto& axes : orders())
            for (const bool radian : {false, true}) all.push_back({axes, fixed, radian});
    const std::size_t plain = all.size();
    for (std::size_t i = 0; i < plain; i += 5) {
        all.push_back(all[i]);
        all.back().inverse = true;
        all.push_back(all[i]);
        all.back().mm = 1000;
        all.push_back(all[i]);
        all.back().mm = 25.4;
        all.back().inverse = true;
    }
    return all;
}

TEST(ConventionTrials, SphereInEveryWritingAndNoise) {
    std::map<double, Tally> tallies;
    unsigned seed = 100;
    // Every third writing at one of the levels of noise: a search takes seconds.
    const std::vector<Writing> all = writings();
    const double levels[] = {0.01, 0.05, 0.15};
    for (std::size_t i = 0; i < all.size(); i += 3) {
        const Writing& w = all[i];
        const double noise = levels[i / 3 % 3];
        Random random(++seed);
        simulation::SphereCell cell = simulation::any_cell(random);
        cell.noise_mm = noise;
        cell.robot_mm = noise;
        cell.robot_deg = noise / 10;
        const auto data = sphere_data(cell, simulation::sphere_observations(cell, 9, random),
                                      [&](const Pose& p) { return misread(p, w); });
        tallies[noise].count(asked("tcp-sphere", data), "base_from_flange", w.code());
    }
    for (const auto& [noise, t] : tallies) {
        std::printf("sphere, noise %.2f mm: %d asked, %d named, %d cannot tell, %d wrong\n", noise, t.asked,
                    t.named, t.cannot_tell, t.wrong);
        EXPECT_EQ(t.wrong, 0) << noise;
        // Nine profiles leave nine degrees at most: with more noise it is mostly "cannot tell".
        if (noise < 0.02) {
            EXPECT_GE(3 * t.named, 2 * t.asked) << noise;
        }
    }
}

TEST(ConventionTrials, HandEyeInEveryWritingAndNoise) {
    std::map<double, Tally> tallies;
    unsigned seed = 1000;
    const double levels[] = {0.05, 0.2, 0.8};
    const std::vector<Writing> all = writings();
    for (std::size_t level = 0; level < 3; ++level)
        for (std::size_t i = level; i < all.size(); i += 3) {  // each writing at one level
            const Writing& w = all[i];
            const double noise = levels[level];
            if (w.inverse && w.axes == "zyx" && !w.fixed && !w.radian && w.mm == 1) continue;
            Random random(++seed);
            simulation::HandEyeCell cell = simulation::any_hand_eye_cell(random);
            cell.sigma_mm = noise;
            cell.sigma_rad = noise / 150;
            const auto robot = [&](const Pose& p) { return misread(p, w); };
            const std::function<json(const Pose&)> written = robot,
                                                   usual = [](const Pose&p) { return misread(p, {}); };
            const auto data =
                hand_eye_data(cell.mount, simulation::hand_eye_pairs(cell, 8, random), written, usual);
            tallies[noise].count(asked("hand-eye", data), "base_from_flange", w.code());
        }
    for (const auto& [noise, t] : tallies) {
        std::printf("hand-eye, noise %.2f mm: %d asked, %d named, %d cannot tell, %d wrong\n", noise, t.asked,
                    t.named, t.cannot_tell, t.wrong);
        EXPECT_EQ(t.wrong, 0) << noise;
        EXPECT_GE(t.named, noise < 0.5 ? 0.9 * t.asked : 0.5 * t.asked) << noise;
    }
}

// Small turns tell little: what is named must be right, however little that is.
TEST(ConventionTrials, SmallTurnsAndFewPosesAreNeverNamedWrongly) {
    Tally t;
    unsigned seed = 5000;
    for (const double tilt : {2.0, 6.0, 12.0})
        for (const int poses : {4, 12})
            for (const Writing& w : writings()) {
                if (w.radian || w.mm != 1) continue;
                Random random(++seed);
                simulation::HandEyeCell cell = simulation::any_hand_eye_cell(random);
                cell.tilt_deg = tilt;
                cell.turn_deg = tilt;
                const std::function<json(const Pose&)> written = [&](const Pose&p) { return misread(p, w); },
                                                       usual = [](const Pose&p) { return misread(p, {}); };
                const auto data = hand_eye_data(cell.mount, simulation::hand_eye_pairs(cell, poses, random),
                                                written, usual);
                t.count(asked("hand-eye", data), "base_from_flange", w.code());
            }
    std::printf("small turns: %d asked, %d named, %d cannot tell, %d wrong\n", t.asked, t.named,
                t.cannot_tell, t.wrong);
    EXPECT_LE(t.wrong, t.asked / 100);
}

TEST(ConventionDetective, NamesWhatTheSphereWasWrittenIn) {
    for (const Writing& w : {Writing{"xyz", true}, Writing{"zyx", false, false, false, 1000}}) {
        const auto answer = asked("tcp-sphere", sphere(5, as(w)));
        ASSERT_EQ(answer.result["verdict"], "named") << w.code() << answer.result;
        EXPECT_EQ(answer.offer["base_from_flange"], w.code());
        EXPECT_LT(answer.result["best"]["residual_mm"], 0.5);
        // Taken by saying it: the calibration is then good, and the file's numbers are what they were.
        json data = sphere(5, as(w));
        data["pose_convention"] = answer.offer;
        const auto solved = solve_calibration(*find_method("tcp-sphere"), data, {});
        ASSERT_TRUE(solved) << solved.error().sentence();
        EXPECT_EQ(solved->document["status"], "ok") << solved->document["reason"];
        EXPECT_EQ(solved->document["pose_convention"], answer.offer);
        EXPECT_EQ(asked("tcp-sphere", data).result["verdict"], "as_given");
    }
}

TEST(ConventionDetective, NamesQuaternionsAndMatrices) {
    const auto name = [](const WriteOne& written) {
        const auto answer = asked("tcp-sphere", sphere(6, written));
        return answer.result["verdict"] == "named" ? answer.offer["base_from_flange"].get<std::string>()
                                                   : answer.result.dump();
    };
    EXPECT_EQ(name([](const Pose& p) { return quaternion(p, false, false); }), "quat-xyzw,mm");
    EXPECT_EQ(name([](const Pose& p) { return quaternion(p.inverse(), false, false); }),
              "quat-xyzw,mm,inverse");
    EXPECT_EQ(name([](const Pose& p) { return matrix(p, true, true); }), "matrix,mm,transposed");
}

// One angle alone: the turns about the axis read alike in half of the conventions.
TEST(ConventionDetective, OneAxisCannotBeToldAndNamesBoth) {
    Random random(12);
    SphereCell cell = any_cell(random);
    cell.tilt_deg = 0;
    auto observations = simulation::sphere_observations(cell, 12, random);
    std::vector<Writing> equal;
    for (const bool fixed : {false, true})
        for (const auto& axes : orders())
            if (axes.find('z') == 2 && axes[0] != axes[2]) equal.push_back({axes, fixed});
    // Flange poses that turn about z alone, written in an order that ends in z, read in one that begins with it.
    for (auto& o : observations) {
        Pose p = o.base_from_flange;
        const double turn = rotation_log(p.linear()).z();
        o.base_from_flange = make_pose(elsewhere::turn('z', turn), p.translation());
    }
    const auto answer = asked("tcp-sphere", sphere_data(cell, observations, as(equal.front())));
    EXPECT_EQ(answer.result["verdict"], "cannot_tell") << answer.result;
}

TEST(ConventionDetective, NoiseAndAWrongRadiusEndHonestly) {
    Random random(13);
    const WriteOne noise = [&](const Pose&) {
        return json{
            {"xyz", {simulation::uniform(random, -900, 900), simulation::uniform(random, -900, 900), 700}},
            {"abc",
             {simulation::uniform(random, -180, 180), simulation::uniform(random, -90, 90),
              simulation::uniform(random, -180, 180)}}};
    };
    const auto of_noise = asked("tcp-sphere", sphere(14, noise));
    EXPECT_EQ(of_noise.result["verdict"], "cannot_tell") << of_noise.result;
    EXPECT_GT(of_noise.result["tried"], 90);
    json wrong_radius = sphere(15, kAsTheHouse);
    wrong_radius["radius_mm"] = 14.5;
    EXPECT_EQ(asked("tcp-sphere", wrong_radius).result["verdict"], "cannot_tell");
    EXPECT_EQ(asked("hand-eye", hand_eye(17, noise, kAsTheHouse)).result["verdict"], "cannot_tell");
}

}  // namespace
}  // namespace seamwright
