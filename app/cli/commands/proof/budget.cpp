// seamwright budget: what the uncertainty of a correction is made of.

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "app/cli/arguments/pose_argument.h"
#include "app/cli/command.h"
#include "app/cli/signal_watch.h"
#include "devices/exchange/files.h"
#include "projects/file/project_file.h"
#include "projects/proof/budget_json.h"
#include "projects/proof/budget_page.h"

namespace seamwright::cli {
namespace {

struct BudgetArguments {
    std::string file, region, displacement, out, language = "en";
    BudgetOptions options;
};

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
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
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
    if (a.out.empty()) return answer;
    page.language = *language_from(a.language);
    SEAM_OK(write_text_file(a.out, budget_page(budgets, page).html()));
    answer.json["html"] = a.out;
    answer.text += a.out + " written\n";
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
