// seamwright expose: what the sensor is set to at each spot, and the light that suits it, found on the part.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>

#include "app/cli/answers/result_json.h"
#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "projects/station/light/spot_light.h"
#include "projects/station/station.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct ExposeArguments {
    std::string file, paint, follow;
    std::vector<std::string> spots, set;
    std::vector<double> merge;
    bool all = false, find = false, keep = false, fixed = false, clear = false;
    FindLightOptions search;

    bool edits() const { return !set.empty() || !merge.empty() || !follow.empty() || fixed || clear; }
};

std::string settings_text(const ParameterValues& settings) {
    std::vector<std::string> parts;
    for (const auto& [name, value] : settings) parts.push_back(fmt::format("{} {:g}", name, value));
    return parts.empty() ? "as the sensor stands" : fmt::format("{}", fmt::join(parts, ", "));
}

json spot_json(const Spot& spot) {
    const SpotLight& light = spot.light;
    json out = {{"id", spot.id},
                {"sensor", spot.sensor_id},
                {"settings", light.settings},
                {"merge_us", light.merge_us},
                {"follow_us", light.follows_paint() ? json{light.shortest_us, light.longest_us} : json()},
                {"paints", json::object()},
                {"reference", spot.reference_light ? light_json(*spot.reference_light) : json()}};
    for (const PaintLight& p : light.paints) out["paints"][p.paint] = p.settings;
    return out;
}

std::string spot_text(const Spot& spot) {
    const SpotLight& light = spot.light;
    std::string text = fmt::format("{:<12} {}", spot.id, settings_text(light.settings));
    if (!light.merge_us.empty()) text += fmt::format("; merges {} us", fmt::join(light.merge_us, ", "));
    if (light.follows_paint())
        text += fmt::format("; follows the paint, {:g} to {:g} us", light.shortest_us, light.longest_us);
    text += "\n";
    for (const PaintLight& p : light.paints)
        text += fmt::format("{:<12}   paint {}: {}\n", "", p.paint, settings_text(p.settings));
    if (spot.reference_light)
        text += fmt::format("{:<12}   reference: {}\n", "", settings_text(spot.reference_light->settings));
    return text;
}

// The named ones, in the project's order.
Expected<std::vector<Spot*>> chosen_spots(Project& project, const ExposeArguments& a) {
    std::vector<Spot*> chosen;
    for (const std::string& id : a.spots)
        if (!find_spot(project, id))
            return input_error(Text("there is no spot \"{}\"", id), a.file, "see `seamwright info`");
    for (Spot& spot : project.spots)
        if (a.all || std::find(a.spots.begin(), a.spots.end(), spot.id) != a.spots.end())
            chosen.push_back(&spot);
    if (chosen.empty()) return usage_error("no spot is named", a.file, "give --spots S1,S2 or --all");
    return chosen;
}

Expected<double> number_in(std::string_view text, const char* option) {
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return usage_error(Text("\"{}\" is no number", std::string(text)), option, "write 800, or 12.5");
    return value;
}

Expected<ParameterValues> settings_in(const std::vector<std::string>& set) {
    ParameterValues settings;
    for (const std::string& one : set) {
        const std::size_t at = one.find('=');
        if (at == std::string::npos || at == 0)
            return usage_error(Text("\"{}\" sets nothing", one), "--set",
                               "write NAME=VALUE: exposure_us=800");
        SEAM_TRY(settings[one.substr(0, at)], number_in(std::string_view(one).substr(at + 1), "--set"));
    }
    return settings;
}

// As a person said it.
Expected<void> edit(Spot& spot, const ExposeArguments& a) {
    SpotLight& light = spot.light;
    if (a.clear) light = {};
    if (a.fixed) light.shortest_us = light.longest_us = 0;
    SEAM_TRY(const auto settings, settings_in(a.set));
    ParameterValues* into = &light.settings;
    if (!a.paint.empty()) {
        auto known = std::find_if(light.paints.begin(), light.paints.end(),
                                  [&](const PaintLight& p) { return p.paint == a.paint; });
        if (known == light.paints.end()) known = light.paints.insert(known, {a.paint, {}});
        into = &known->settings;
    }
    for (const auto& [name, value] : settings) (*into)[name] = value;
    if (!a.merge.empty()) {
        light.merge_us = a.merge;
        light.shortest_us = light.longest_us = 0;
    }
    if (!a.follow.empty()) {
        const std::size_t dots = a.follow.find("..");
        if (dots == std::string::npos)
            return usage_error(Text("\"{}\" is no range", a.follow), "--follow", "write 100..3000");
        SEAM_TRY(light.shortest_us, number_in(std::string_view(a.follow).substr(0, dots), "--follow"));
        SEAM_TRY(light.longest_us, number_in(std::string_view(a.follow).substr(dots + 2), "--follow"));
        light.merge_us.clear();
    }
    return {};
}

Expected<void> sound(const Project& project, const Spot& spot) {
    const SensorSetup* sensor = find_sensor(project, spot.sensor_id);
    return sensor ? check_light(spot, *sensor) : Expected<void>();
}

json found_json(const std::string& id, const FoundLight& found) {
    json tried = json::array();
    for (const TriedLight& t : found.tried)
        tried.push_back({{"settings", t.settings},
                         {"verdict", to_string(t.verdict)},
                         {"lit", t.stripe.lit},
                         {"lines", t.stripe.lines},
                         {"bright", t.stripe.bright},
                         {"dark", t.stripe.dark},
                         {"saturated_share", t.stripe.saturated_share()},
                         {"width_px", t.stripe.width_px},
                         {"surrounding", t.surrounding},
                         {"for_dark_lines", t.for_dark_lines}});
    return {{"id", id},
            {"verdict", to_string(found.verdict)},
            {"settings", found.settings},
            {"merge_us", found.merge_us},
            {"unserved_share", found.unserved_share},
            {"longest_us", found.longest_us},
            {"tried", std::move(tried)}};
}

std::string found_text(const Spot& spot, const FoundLight& found) {
    std::string text = fmt::format("{}: {}\n", spot.id, to_string(found.verdict));
    for (const TriedLight& t : found.tried)
        text += fmt::format(
            "  {:<34} {:<10} bright lines {:3.0f} %, dark {:3.0f} %, cut off {:4.1f} %, width {:4.1f} px, {} "
            "of {} "
            "lines{}\n",
            settings_text(t.settings), to_string(t.verdict), 100 * t.stripe.bright, 100 * t.stripe.dark,
            100 * t.stripe.saturated_share(), t.stripe.width_px, t.stripe.lit, t.stripe.lines,
            t.for_dark_lines ? " (for the dark ones)" : "");
    text += "  " + settings_text(found.settings) + "\n";
    if (!found.merge_us.empty())
        text += fmt::format("  no single exposure shows all lines: merge {} us\n",
                            fmt::join(found.merge_us, ", "));
    else if (found.unserved_share > 0.03)
        text += fmt::format(
            "  {:.0f} % of the lines are too dark in it{}\n", 100 * found.unserved_share,
            spot.stop_at_trigger ? "" : "; a spot at which the robot stops can merge several exposures");
    return text;
}

Expected<Answer> find(const ExposeArguments& a) {
    SEAM_TRY(auto station, open_station(a.file, a.keep ? std::optional(Deed::teach) : std::nullopt));
    Project project = station.project();
    SEAM_TRY(const auto chosen, chosen_spots(project, a));
    FindLightOptions search = a.search;
    search.cancel = stop_on_signal();
    SEAM_OK(station.connect());
    Answer answer;
    answer.json = {{"status", "ok"}, {"kept", a.keep}, {"spots", json::array()}};
    bool all = true;
    for (Spot* spot : chosen) {
        SEAM_TRY(const auto found, find_light(station, *spot, search));
        answer.json["spots"].push_back(found_json(spot->id, found));
        answer.text += found_text(*spot, found);
        if (found.verdict != LightVerdict::fit) {
            all = false;
            continue;
        }
        if (!a.keep) continue;
        if (a.paint.empty()) {
            for (const auto& [name, value] : found.settings) spot->light.settings[name] = value;
            spot->light.merge_us = found.merge_us;
            if (!found.merge_us.empty()) spot->light.shortest_us = spot->light.longest_us = 0;
        } else {
            std::erase_if(spot->light.paints, [&](const PaintLight& p) { return p.paint == a.paint; });
            spot->light.paints.push_back({a.paint, found.settings});
        }
        SEAM_OK(sound(project, *spot));
    }
    station.disconnect();
    if (a.keep) {
        SEAM_OK(station.edit(project));
        answer.text += "kept in the project; teach the references anew where the light changed much\n";
    }
    if (!all) {
        answer.exit_code = kExitVerdict;
        answer.json["status"] = "not_found";
    }
    return answer;
}

Expected<Answer> expose(const ExposeArguments& a) {
    if (a.find && a.edits())
        return usage_error("what is found and what is set are two things", a.file,
                           "give --find, or --set, --merge, --follow, --fixed, --clear");
    if (a.keep && !a.find) return usage_error("there is nothing to keep", "--keep", "give --find with it");
    if (a.find) return find(a);
    Answer answer;
    answer.json = {{"status", "ok"}, {"spots", json::array()}};
    SEAM_TRY(auto file, a.edits() ? open_to_edit(a.file) : ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(auto project, file.load());
    if (a.edits()) {
        SEAM_TRY(const auto chosen, chosen_spots(project, a));
        for (Spot* spot : chosen) {
            SEAM_OK(edit(*spot, a));
            SEAM_OK(sound(project, *spot));
        }
        SEAM_OK(file.save(project));
    }
    for (const Spot& spot : project.spots) {
        answer.json["spots"].push_back(spot_json(spot));
        answer.text += spot_text(spot);
    }
    if (project.spots.empty()) answer.text = "the project has no spot\n";
    return answer;
}

}  // namespace

void add_expose(CommandLine& line) {
    auto a = std::make_shared<ExposeArguments>();
    CLI::App* command =
        line.add("expose",
                 "What the sensor is set to at each spot: exposure, gain and whatever else the device lists. "
                 "Without options the "
                 "list. With\n--find the robot goes to the spots, and the light is found from the stripe in "
                 "at most five "
                 "frames; where no single exposure\nshows all of a contour that is half black, half shining, "
                 "several are found that "
                 "are merged line by line.",
                 "seamwright expose door_left.seam --spots T1,T2 --find --keep\n"
                 "  seamwright expose door_left.seam --all --find --paint white --keep\n"
                 "  seamwright expose door_left.seam --spots T1 --set exposure_us=800 --set gain_db=3\n"
                 "  seamwright expose door_left.seam --all --follow 100..3000\n"
                 "  seamwright expose door_left.seam --spots T3 --merge 250,2000");
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    auto* spots = command->add_option("--spots", a->spots, "Which spots");
    spots->delimiter(',')->type_name("S1,S2,...");
    command->add_flag("--all", a->all, "All spots")->excludes(spots);
    auto* found =
        command->add_flag("--find", a->find, "Find the light on the part; the robot goes to each spot");
    command->add_flag("--keep", a->keep, "Keep what was found in the project");
    command
        ->add_option(
            "--longest-us", a->search.longest_us,
            "The longest exposure allowed; 0: the sensor's, and for a spot that is passed what its jitter "
            "window allows")
        ->check(CLI::Range(0.0, 1e6))
        ->capture_default_str()
        ->needs(found);
    command
        ->add_option("--highest-gain-db", a->search.highest_gain_db,
                     "Gain is raised up to this, where the longest exposure is too short")
        ->check(CLI::Range(0.0, 60.0))
        ->capture_default_str()
        ->needs(found);
    command->add_option("--set", a->set, "A setting of the spot, by the device's own name; may be repeated")
        ->type_name("NAME=VALUE");
    command
        ->add_option(
            "--paint", a->paint,
            "What is set or found counts on this colour, as `run --paint` or the line's number names it")
        ->type_name("NAME");
    command
        ->add_option("--merge", a->merge,
                     "Exposures merged line by line, ascending; the robot has to stop at the spot")
        ->delimiter(',')
        ->type_name("US,US,...");
    command->add_option("--follow", a->follow, "The exposure follows the paint between these at run time")
        ->type_name("US..US");
    command->add_flag("--fixed", a->fixed, "It does not any more");
    command->add_flag("--clear", a->clear, "Nothing of the spot's own any more");
    line.on(command, [a] { return expose(*a); });
}

}  // namespace seamwright::cli
