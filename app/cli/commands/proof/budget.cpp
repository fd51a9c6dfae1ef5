// seamwright budget: what the uncertainty of a correction is made of.

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "app/cli/arguments/pose_argument.h"
#include "app/cli/command.h"
#include "app/cli/signal_watch.h"
#include "core/number_text.h"
#include "devices/exchange/files.h"
#include "projects/file/project_file.h"
#include "projects/proof/budget/budget_json.h"
#include "projects/proof/budget/budget_page.h"

namespace seamwright::cli {
namespace {

struct BudgetArguments {
    std::string file, region, displacement, out, language = "en";
    std::vector<std::string> state;
    BudgetOptions options;
};

constexpr const char* kStates =
    "workobject_mm, workobject_deg, ROBOT:speed_change, SENSOR:scale_x, SENSOR:scale_z or SENSOR:shear";

// "A:scale_x=0.0005": what nobody measures in the cell, one standard deviation, into the project.
Expected<void> state(Project& project, const std::string& entry) {
    const std::size_t equals = entry.rfind('=');
    const std::string left = entry.substr(0, equals);
    const std::size_t colon = left.rfind(':');
    const std::string id = colon == std::string::npos ? "" : left.substr(0, colon);
    const std::string name = colon == std::string::npos ? left : left.substr(colon + 1);
    const Text where("--state {}", entry);
    const auto value = equals == std::string::npos
                           ? std::nullopt
                           : number_from<double>(std::string_view(entry).substr(equals + 1));
    if (!value || !std::isfinite(*value) || *value < 0)
        return usage_error("no NAME=VALUE with one standard deviation of 0 or more", where,
                           Text("give {}", kStates));
    const auto up_to = [&](double most, const char* unit) -> Expected<void> {
        if (*value <= most) return {};
        return usage_error(Text("{:g} is more than {:g} {}", *value, most, unit), where,
                           "one standard deviation is meant, not a limit");
    };
    if (id.empty() && name == "workobject_mm") {
        SEAM_OK(up_to(100, "mm"));
        project.part.workobject_covariance.topLeftCorner<3, 3>() =
            *value * *value * Eigen::Matrix3d::Identity();
        return {};
    }
    if (id.empty() && name == "workobject_deg") {
        SEAM_OK(up_to(5, "degrees"));
        const double rad = rad_from_deg(*value);
        project.part.workobject_covariance.bottomRightCorner<3, 3>() =
            rad * rad * Eigen::Matrix3d::Identity();
        return {};
    }
    if (name == "speed_change") {
        SEAM_OK(up_to(1, "of the speed"));
        for (RobotSetup& robot : project.robots)
            if (robot.id == id) {
                robot.speed_sigma = *value;
                return {};
            }
        return usage_error(Text("there is no robot \"{}\"", id), where);
    }
    if (name != "scale_x" && name != "scale_z" && name != "shear")
        return usage_error(Text("nothing is called \"{}\"", name), where, Text("give {}", kStates));
    SEAM_OK(up_to(0.1, "of a length"));
    for (const SensorSetup& sensor : project.sensors) {
        if (sensor.id != id) continue;
        for (Calibration& c : project.calibrations) {
            if (c.id != sensor.calibration_id || c.id.empty()) continue;
            (name == "shear" ? c.shear_sigma : c.scale_sigma[name == "scale_x" ? 0 : 1]) = *value;
            return {};
        }
        return usage_error(Text("sensor {} has no calibration that could hold it", id), where,
                           "calibrate it first");
    }
    return usage_error(Text("there is no sensor \"{}\"", id), where);
}

Expected<std::vector<RegionBudget>> budgets_of(const BudgetArguments& a, const Project& project) {
    std::vector<RegionBudget> budgets;
    bool known = false;
    for (const Region& region : project.regions) {
        if (!a.region.empty() && region.id != a.region) continue;
        known = true;
        BudgetOptions options = a.options;
        options.drawing.cancel = stop_on_signal();
        options.drawing.progress = [&](std::size_t trials) {
            fmt::print(stderr, "region {}: {} trials\n", region.id, trials);
        };
        auto budget = region_budget(project, region, options);
        if (!budget) {
            budget.error().within(a.file);
            return tl::unexpected(budget.error());
        }
        budgets.push_back(std::move(*budget));
    }
    if (known) return budgets;
    if (project.regions.empty()) return input_error("the project has no region", a.file);
    std::vector<Text> ids;
    for (const Region& region : project.regions) ids.push_back(region.id);
    return usage_error(Text("there is no region \"{}\"", a.region), a.file,
                       Text("name one of {}", listed(ids)));
}

Expected<Answer> budget_command(const BudgetArguments& given) {
    BudgetArguments a = given;
    SEAM_TRY(auto displacement, read_pose_argument(a.displacement, "--displacement"));
    a.options.displacement.workobject_from_movedworkobject = displacement;
    SEAM_TRY(auto file,
             ProjectFile::open(a.file, a.state.empty() ? FileAccess::read_only : FileAccess::read_write));
    SEAM_TRY(auto project, file.load());
    for (const std::string& entry : a.state) SEAM_OK(state(project, entry));
    SEAM_TRY(auto budgets, budgets_of(a, project));
    BudgetPageOptions page;
    page.file = std::filesystem::path(a.file).filename().string();
    page.program = "Seamwright " SEAMWRIGHT_VERSION;
    Answer answer;
    answer.text = budget_page(budgets, page).text();
    bool determined = true, holds = true;
    nlohmann::json regions = nlohmann::json::array();
    for (const RegionBudget& b : budgets) {
        determined = determined && b.status == CorrectionStatus::ok;
        holds = holds && b.first_order_holds();
        regions.push_back(budget_json(b));
    }
    const char* status = !determined ? "under_determined" : holds ? "ok" : "first_order_does_not_hold";
    answer.json = {
        {"status", status}, {"required_sigma3_mm", project.requirements.sigma3_mm}, {"regions", regions}};
    answer.exit_code = determined && holds ? kExitOk : kExitVerdict;
    if (!a.out.empty()) {
        page.language = *language_from(a.language);
        SEAM_OK(write_text_file(a.out, budget_page(budgets, page).html()));
        answer.json["html"] = a.out;
        answer.text += a.out + " written\n";
    }
    if (!a.state.empty()) SEAM_OK(file.save(project));  // last: what is refused above changes nothing
    return answer;
}

}  // namespace

void add_budget(CommandLine& line) {
    auto a = std::make_shared<BudgetArguments>();
    CLI::App* command = line.add(
        "budget",
        "Uncertainty budget (GUM) of each region's correction: what contributes how much to the deviation "
        "across "
        "the bead at the worst path point and to the six degrees of freedom, random and systematic. With "
        "--monte-carlo the whole correction is run on drawn inputs (JCGM 101) beside it; exit code 1 where "
        "the two disagree or a region is under-determined.",
        "seamwright budget door_left.seam --displacement '{\"xyz\":[10,5,0],\"abc\":[0.5,0,0]}' "
        "--monte-carlo "
        "--out budget.html");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    command->add_option("--region", a->region, "One region; else all of them");
    command
        ->add_option("--displacement", a->displacement,
                     "Where the part lies, D of the correction: JSON or a file of it; else as taught")
        ->type_name("POSE");
    command
        ->add_option(
            "--state", a->state,
            std::string(
                "Keep in the project what nobody measures in the cell, one standard deviation, may be "
                "repeated: ") +
                kStates +
                " (the work object that the path is laid in, against that of the measuring; the share by "
                "which the speed at the spots differs from that of the teaching; the sensor's own "
                "millimetres, of a maker's data sheet)")
        ->type_name("NAME=VALUE");
    command->add_flag("--monte-carlo", a->options.monte_carlo, "Draw the inputs and run the real correction");
    command->add_option("--seed", a->options.seed, "Of the draws")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    command
        ->add_option("--most-trials", a->options.drawing.most,
                     "Stop drawing here where the 95 % limits do not stand to 1 % of u before")
        ->check(CLI::Range(std::size_t{1000}, std::size_t{10000000}))
        ->capture_default_str();
    command->add_option("--out", a->out, "The budget as one self-contained page")->type_name("FILE.html");
    command->add_option("--language", a->language, "Of the page: en or de")
        ->check(CLI::IsMember({"en", "de"}))
        ->capture_default_str();
    line.on(command, [a] { return budget_command(*a); });
}

}  // namespace seamwright::cli
