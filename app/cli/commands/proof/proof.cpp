// seamwright zero-shift, known-shift: what is proven before the first part.

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <iostream>

#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "core/geometry/notation.h"
#include "devices/exchange/files.h"
#include "devices/exchange/pose_json.h"
#include "devices/exchange/tables/csv_table.h"
#include "devices/registry.h"
#include "projects/proof/known_shift.h"
#include "projects/proof/zero_shift.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

constexpr std::array<const char*, 6> kNames{"x_mm", "y_mm", "z_mm", "a_deg", "b_deg", "c_deg"};
constexpr std::array<const char*, 3> kKinds{"translation", "rotation", "both"};

Expected<Station> open_connected(const std::string& file) {
    auto station = open_station(file, Deed::teach);
    if (!station) return station;
    SEAM_OK(station->connect());
    return station;
}

Expected<Answer> zero_shift(const std::string& file, int runs, const std::string& type) {
    SEAM_TRY(auto station, open_connected(file));
    ZeroShiftOptions options;
    options.runs = runs;
    options.part_type = type;
    options.cancel = stop_on_signal();
    options.progress = [](const RunProgress& p) {
        fmt::print(stderr, "[{}/{}] {}\n", p.done, p.total, p.text);
    };
    SEAM_TRY(auto zero, measure_zero_shift(station, options));
    const double required = station.project().requirements.sigma3_mm;
    Answer answer;
    json regions = json::array();
    double worst = 0;
    for (const ZeroShiftRegion& r : zero.regions) {
        worst = std::max(worst, r.worst_mean_mm);
        json values = json::object();
        answer.text += fmt::format("region {}: the mean moves a spot by {:.3f} mm at most\n", r.region_id,
                                   r.worst_mean_mm);
        for (std::size_t k = 0; k < 6; ++k) {
            values[kNames[k]] = {{"mean", r.mean[k]},
                                 {"three_sigma", r.three_sigma[k]},
                                 {"stated_three_sigma", r.stated_three_sigma[k]}};
            answer.text += fmt::format("  {:<6} mean {:8.4f}  3 sigma {:7.4f}  stated {:7.4f}\n", kNames[k],
                                       r.mean[k], r.three_sigma[k], r.stated_three_sigma[k]);
        }
        regions.push_back({{"id", r.region_id}, {"worst_mean_mm", r.worst_mean_mm}, {"values", values}});
    }
    const bool ok = zero.refused == 0 && worst <= required;
    answer.exit_code = ok ? kExitOk : kExitVerdict;
    answer.json = {{"status", ok ? "ok" : "not_zero"}, {"runs", zero.runs},
                   {"refused", zero.refused},          {"worst_mean_mm", worst},
                   {"required_sigma3_mm", required},   {"regions", regions}};
    answer.text += fmt::format("{}: {} runs, {} refused, mean within {:.3f} mm, required {:.3f} mm\n",
                               ok ? "ok" : "not zero", zero.runs.size(), zero.refused, worst, required);
    return answer;
}

struct KnownShiftArguments {
    std::string file, by, csv, type;
    ShiftGrid grid;
};

// What a person sets on the controller, then return; anything else ends the proof.
bool ask_to_place(const ShiftTest& test, const Pose& shift, const KnownShift& proof) {
    const KukaAbc s = kuka_from_rotation(shift.linear());
    const Pose& d = test.workobject_from_movedworkobject;
    const KukaAbc m = kuka_from_rotation(d.linear());
    fmt::print(
        stderr,
        "\n{}\n  base shift    X {:9.3f}  Y {:9.3f}  Z {:9.3f} mm  A {:8.4f}  B {:8.4f}  C {:8.4f} deg\n"
        "  or move the part, in the work object\n"
        "                X {:9.3f}  Y {:9.3f}  Z {:9.3f} mm  A {:8.4f}  B {:8.4f}  C {:8.4f} deg\n"
        "Return when it stands, q to end: ",
        shift_name(test, proof), shift.translation().x(), shift.translation().y(), shift.translation().z(),
        s.a_deg, s.b_deg, s.c_deg, d.translation().x(), d.translation().y(), d.translation().z(), m.a_deg,
        m.b_deg, m.c_deg);
    std::string line;
    return std::getline(std::cin, line) && line.empty();
}

// One row a spot and displacement.
std::string csv_of(const KnownShift& proof) {
    std::string text = "kind,axis,amount,run,region,ok,spot,dx_mm,dy_mm,dz_mm\n";
    for (const ShiftTest& test : proof.tests)
        for (const ShiftOutcome& o : test.regions) {
            const std::string head =
                fmt::format("{},{},{},{},{},{}", kKinds[static_cast<std::size_t>(test.kind)],
                            "XYZ"[test.axis], test.amount, test.run, csv::field(o.region_id), o.ok ? 1 : 0);
            if (o.deviations_mm.empty()) text += head + ",,,,\n";
            for (std::size_t i = 0; i + 2 < o.deviations_mm.size(); i += 3)
                text += fmt::format("{},{},{:.6f},{:.6f},{:.6f}\n", head, i / 3 + 1, o.deviations_mm[i],
                                    o.deviations_mm[i + 1], o.deviations_mm[i + 2]);
        }
    return text;
}

Expected<Answer> known_shift(const KnownShiftArguments& a) {
    SEAM_TRY(auto station, open_station(a.file, Deed::teach));
    const Project project = station.project();
    KnownShiftOptions options;
    options.grid = a.grid;
    options.part_type = a.type;
    options.by = a.by == "part"   ? ShiftBy::simulated_part
                 : a.by == "base" ? ShiftBy::robot_moves
                                  : ShiftBy::by_hand;
    if (a.by.empty())
        options.by = !project.sensors.empty() && is_simulated_cell(project.sensors.front().driver)
                         ? ShiftBy::simulated_part
                         : ShiftBy::robot_moves;
    options.cancel = stop_on_signal();
    options.progress = [](const RunProgress& p) {
        fmt::print(stderr, "[{}/{}] {}\n", p.done, p.total, p.text);
    };
    KnownShift naming;
    naming.range_mm = a.grid.range_mm;
    naming.range_deg = a.grid.range_deg;
    if (isatty(fileno(stdin)))
        options.place = [&](const ShiftTest& test, const Pose& shift) {
            return ask_to_place(test, shift, naming);
        };
    SEAM_TRY(auto proof, prove_known_shift(station, options));
    if (!a.csv.empty()) SEAM_OK(write_text_file(a.csv, csv_of(proof)));

    const double required = project.requirements.sigma3_mm;
    Answer answer;
    answer.text =
        fmt::format("{:<10} {:<12} {:>5} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9} {:>12}\n", "region", "shift",
                    "tests", "refused", "mean", "min", "max", "var", "3 sigma", "about truth");
    json table = json::array(), regions = json::array(), tests = json::array();
    for (const ShiftStatistic& s : statistics(proof)) {
        const char* kind = kKinds[static_cast<std::size_t>(s.kind)];
        answer.text +=
            fmt::format("{:<10} {:<12} {:>5} {:>7} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:>9.4f} {:>12.4f}\n",
                        s.region_id.empty() ? "all" : s.region_id, kind, s.tests, s.refused, s.summary.mean,
                        s.summary.minimum, s.summary.maximum, s.summary.variance, s.summary.three_sigma,
                        s.about_truth_mm);
        table.push_back({{"region", s.region_id},
                         {"kind", kind},
                         {"tests", s.tests},
                         {"refused", s.refused},
                         {"mean_mm", s.summary.mean},
                         {"min_mm", s.summary.minimum},
                         {"max_mm", s.summary.maximum},
                         {"variance_mm2", s.summary.variance},
                         {"three_sigma_mm", s.summary.three_sigma},
                         {"about_truth_mm", s.about_truth_mm}});
    }
    bool ok = true;
    for (const Region& region : project.regions) {
        const ProvenAccuracy proven = proven_accuracy(proof, region.id);
        const bool holds = proven.refused == 0 && proven.tests > 0 && proven.three_sigma_mm <= required;
        ok = ok && holds;
        regions.push_back({{"id", region.id},
                           {"ok", holds},
                           {"three_sigma_mm", proven.three_sigma_mm},
                           {"worst_mm", proven.worst_mm},
                           {"refused", proven.refused}});
        answer.text +=
            fmt::format("region {}: {}, 3 sigma {:.3f} mm about the truth, required {:.3f} mm{}\n", region.id,
                        holds ? "recovered" : "not recovered", proven.three_sigma_mm, required,
                        proven.refused ? fmt::format(", {} refused", proven.refused) : "");
    }
    for (const ShiftTest& test : proof.tests) {
        json outcomes = json::array();
        for (const ShiftOutcome& o : test.regions)
            outcomes.push_back({{"region", o.region_id},
                                {"ok", o.ok},
                                {"mean_abs_mm", o.mean_abs_mm},
                                {"deviations_mm", o.deviations_mm},
                                {"message", o.message}});
        tests.push_back({{"name", shift_name(test, proof)},
                         {"kind", kKinds[static_cast<std::size_t>(test.kind)]},
                         {"axis", std::string(1, "XYZ"[test.axis])},
                         {"amount", test.amount},
                         {"displacement", pose_json(test.workobject_from_movedworkobject)},
                         {"run", test.run},
                         {"regions", outcomes}});
    }
    const ProvenRange range = proven_range(proof);
    answer.exit_code = ok ? kExitOk : kExitVerdict;
    answer.json = {{"status", ok ? "ok" : "not_recovered"},
                   {"required_sigma3_mm", required},
                   {"proven_translation_mm", range.translation_mm},
                   {"proven_rotation_deg", range.rotation_deg},
                   {"regions", regions},
                   {"table", table},
                   {"tests", tests}};
    return answer;
}

}  // namespace

void add_proof(CommandLine& line) {
    auto file = std::make_shared<std::string>();
    auto runs = std::make_shared<int>(5);
    CLI::App* zero = line.add("zero-shift",
                              "Measure the unmoved part several times: every displacement must read zero. "
                              "Kept in the project as evidence.",
                              "seamwright zero-shift door_left.seam --runs 10");
    zero->add_option("file", *file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(zero);
    zero->add_option("--runs", *runs, "How often")->check(CLI::Range(2, 1000))->capture_default_str();
    auto type = std::make_shared<std::string>();
    zero->add_option("--type", *type, "Of which part type, when the project has types")->type_name("ID");
    line.on(zero, [file, runs, type] { return zero_shift(*file, *runs, *type); });

    auto a = std::make_shared<KnownShiftArguments>();
    CLI::App* known = line.add(
        "known-shift",
        "Displace the part by known amounts along and about X, Y, Z, measure, and compare: the table of "
        "deviations and 3 sigma for this project. Nothing is written to the robot. Kept in the project as "
        "evidence.",
        "seamwright known-shift door_left.seam --range-mm 10 --step-mm 5 --range-deg 1 --step-deg 0.5");
    known->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(known);
    known
        ->add_option("--by", a->by,
                     "part: the simulated part moves; base: the measuring moves are shifted the other way; "
                     "hand: you shift the controller's base or the part, asked each time")
        ->check(CLI::IsMember({"part", "base", "hand"}));
    known->add_option("--range-mm", a->grid.range_mm, "Largest translation")->capture_default_str();
    known->add_option("--step-mm", a->grid.step_mm, "Its step")->capture_default_str();
    known->add_option("--range-deg", a->grid.range_deg, "Largest rotation")->capture_default_str();
    known->add_option("--step-deg", a->grid.step_deg, "Its step")->capture_default_str();
    known->add_option("--csv", a->csv, "Every deviation, one row a spot and displacement")->type_name("FILE");
    known->add_option("--type", a->type, "Of which part type, when the project has types")->type_name("ID");
    line.on(known, [a] { return known_shift(*a); });
}

}  // namespace seamwright::cli
