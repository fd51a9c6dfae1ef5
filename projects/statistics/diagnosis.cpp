#include "projects/statistics/diagnosis.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <regex>
#include <set>

#include "devices/exchange/json_fields.h"

namespace seamwright {
namespace {

constexpr std::size_t kLongestName = 256;  // of a part, that the pattern is looked for in

Expected<std::vector<Eigen::Vector3d>> unit_directions(std::vector<Eigen::Vector3d> given,
                                                       const std::string& where) {
    if (given.empty() || given.size() > 3)
        return input_error("an element holds the part in one, two or three directions", where,
                           "give \"direction\", \"directions\" or \"pin_axis\"");
    for (Eigen::Vector3d& d : given) {
        if (!(d.norm() > 1e-9))
            return input_error("a direction has no length", where, "give one, [0, 0, 1] for example");
        d.normalize();
    }
    for (std::size_t i = 0; i < given.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (std::abs(given[i].dot(given[j])) > 0.02)
                return input_error("the directions of an element are not at right angles to each other",
                                   where, "give an element for each");
    return given;
}

Expected<FixtureElement> element_from(const nlohmann::json& json, const std::string& where) {
    SEAM_OK(only_fields(json, {"id", "at_mm", "directions", "direction", "pin_axis"}, where));
    FixtureElement e;
    SEAM_TRY(e.id, json_string(json, "id", where));
    SEAM_TRY(e.at_mm, json_vector3(json, "at_mm", where));
    if (e.id.empty()) return input_error("an element of the fixture has no id", where, "give it a name");
    if (json.contains("direction") + json.contains("directions") + json.contains("pin_axis") != 1)
        return input_error("an element of the fixture has one of direction, directions and pin_axis", where,
                           "say in which directions it holds the part");
    if (json.contains("direction")) {
        SEAM_TRY(const auto d, json_vector3(json, "direction", where));
        e.directions = {d};
    } else if (json.contains("pin_axis")) {
        SEAM_TRY(const auto axis, json_vector3(json, "pin_axis", where));
        if (!(axis.norm() > 1e-9))
            return input_error("a direction has no length", where, "give one, [0, 0, 1] for example");
        // The axes of the work object that it is nearest to being across, so that X and Y are said of a pin along Z.
        Eigen::Index along = 0;
        axis.cwiseAbs().maxCoeff(&along);
        const Eigen::Vector3d first = Eigen::Vector3d::Unit((along + 1) % 3), unit = axis.normalized();
        const Eigen::Vector3d across = (first - unit * unit.dot(first)).normalized();
        e.directions = {across, unit.cross(across)};
    } else {
        SEAM_TRY(const auto* list, json_array(json, "directions", where));
        for (std::size_t i = 0; i < list->size(); ++i) {
            const std::string at = json_path(json_path(where, "directions"), i);
            SEAM_TRY(const auto numbers, as_numbers((*list)[i], 3, at));
            e.directions.emplace_back(numbers[0], numbers[1], numbers[2]);
        }
    }
    SEAM_TRY(e.directions, unit_directions(std::move(e.directions), where));
    return e;
}

Expected<std::regex> pattern_from(const std::string& pattern) {
    try {
        std::regex regex(pattern, std::regex::ECMAScript);
        if (regex.mark_count() < 1)
            return input_error("the carrier's pattern has no group", pattern,
                               "put the carrier into parentheses: -C([0-9]+)$");
        return regex;
    } catch (const std::regex_error& e) {
        return input_error(Text("the carrier's pattern is none ({})", e.what()), pattern,
                           "for example -C([0-9]+)$");
    }
}

std::string axis_name(const Eigen::Vector3d& direction) {
    constexpr std::array<const char*, 3> names{"X", "Y", "Z"};
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(direction(axis)) > 0.9962)
            return names[static_cast<std::size_t>(axis)];  // within 5 degree
    return fmt::format("({:.2f} {:.2f} {:.2f})", direction.x(), direction.y(), direction.z());
}

// What a model says is never quite certain.
double percent(double probability) {
    return std::min(99.0, 100 * probability);
}

// Told in the axis' own sense.
double along_axis(const Eigen::Vector3d& direction, double amount) {
    for (int axis = 0; axis < 3; ++axis)
        if (direction(axis) < -0.9962) return -amount;
    return amount;
}

std::string amounts(const FixtureElement& element, const ElementMoved& moved) {
    std::string out;
    double largest = moved.amount_mm.cwiseAbs().maxCoeff();
    for (Eigen::Index i = 0; i < moved.amount_mm.size(); ++i) {
        const double amount = moved.amount_mm(i);
        if (std::abs(amount) < largest && std::abs(amount) < 2 * moved.sigma_mm(i)) continue;
        const Eigen::Vector3d& direction = element.directions[static_cast<std::size_t>(i)];
        out += fmt::format("{}{:+.2f} mm {}", out.empty() ? "" : ", ", along_axis(direction, amount),
                           axis_name(direction));
    }
    return out;
}

std::string motion_words(const Vector6& motion) {
    return fmt::format("X {:+.2f}, Y {:+.2f}, Z {:+.2f} mm; {:+.3f}, {:+.3f}, {:+.3f} deg", motion(0),
                       motion(1), motion(2), deg_from_rad(motion(3)), deg_from_rad(motion(4)),
                       deg_from_rad(motion(5)));
}

class Collecting {
  public:
    Collecting(const Production& production, const CarrierDiagnosisOptions& options, CarrierDiagnosis& out)
        : production_(production), options_(options), out_(out) {}

    Expected<std::vector<CarLies>> cars() {
        SEAM_OK(choose());
        std::vector<CarLies> cars;
        std::optional<Pose> first;
        for (const ProductionRun& run : production_.runs) {
            const auto carrier = carrier_of(run.values.part_id);
            if (!carrier) {
                ++out_.no_carrier;
                continue;
            }
            auto lies = place_of(run, first);
            if (!lies) {
                ++out_.not_solved;
                continue;
            }
            lies->carrier = *carrier;
            lies->day = run.day;
            cars.push_back(std::move(*lies));
            out_.cars.push_back({run.values.number, run.values.part_id, run.values.started_utc});
        }
        return cars;
    }

  private:
    Expected<void> choose() {
        out_.fixture = options_.fixture;
        for (const ProductionFile& file : production_.files) {
            if (!out_.fixture) out_.fixture = file.project.fixture;
            if (file.project.part_types.size() > 1 && options_.runs.type_id.empty())
                return usage_error("the project has several part types, which lie differently",
                                   file.path.string(), "choose one: --type ID");
            std::set<std::string> whole;
            for (const Region& region : file.project.regions) {
                if (!options_.runs.type_id.empty() && region.type_id != options_.runs.type_id) continue;
                if (region.free == kAllFree)
                    whole.insert(region.id);
                else
                    out_.partial_regions.push_back(region.id);
            }
            whole_.push_back(std::move(whole));
        }
        if (out_.fixture && !out_.fixture->carrier_pattern.empty()) {
            SEAM_TRY(regex_, pattern_from(out_.fixture->carrier_pattern));
        }
        if (options_.carriers.empty() && !regex_) out_.carriers = {""};
        return {};
    }

    std::optional<std::size_t> index_of_carrier(const std::string& name) {
        const auto [it, made] = index_.emplace(name, index_.size());
        if (made) out_.carriers.push_back(name);
        return it->second;
    }

    std::optional<std::size_t> carrier_of(const std::string& part) {
        if (const auto it = options_.carriers.find(part); it != options_.carriers.end())
            return index_of_carrier(it->second);
        if (!regex_) return options_.carriers.empty() ? std::optional<std::size_t>(0) : std::nullopt;
        const std::string name = part.substr(0, kLongestName);
        std::smatch found;
        try {
            if (!std::regex_search(name, found, *regex_) || !found[1].matched) return std::nullopt;
        } catch (const std::regex_error&) {  // too much to be looked for
            return std::nullopt;
        }
        return index_of_carrier(found[1].str());
    }

    // Off the first car, F = D D_first^-1, in its tangent about the origin: t_F = t - R_F t_first.
    std::optional<CarLies> place_of(const ProductionRun& run, std::optional<Pose>& first) const {
        Matrix6 information = Matrix6::Zero();
        Vector6 moment = Vector6::Zero();
        bool any = false;
        for (const RegionValue& region : run.values.regions) {
            if (!whole_[run.file].contains(region.region_id)) continue;
            if (region.status != CorrectionStatus::ok && region.status != CorrectionStatus::over_limit)
                continue;
            const Pose& now = region.workobject_from_movedworkobject;
            if (!first) first = now;
            const Pose moved = now * first->inverse();
            Vector6 at;
            at << moved.translation(), rotation_log(moved.linear());
            Matrix6 to_motion = Matrix6::Identity();
            to_motion.topRightCorner<3, 3>() = skew(first->translation());
            const Matrix6 covariance = to_motion * region.covariance * to_motion.transpose();
            const Eigen::LLT<Matrix6> llt(covariance);
            if (llt.info() != Eigen::Success || !at.allFinite()) continue;
            const Matrix6 weight = llt.solve(Matrix6::Identity());
            information += weight;
            moment += weight * at;
            any = true;
        }
        if (!any) return std::nullopt;
        const Eigen::LLT<Matrix6> llt(information);
        if (llt.info() != Eigen::Success) return std::nullopt;
        CarLies car;
        car.at = llt.solve(moment);
        car.covariance = llt.solve(Matrix6::Identity());
        return car;
    }

    const Production& production_;
    const CarrierDiagnosisOptions& options_;
    CarrierDiagnosis& out_;
    std::vector<std::set<std::string>> whole_;  // regions of six free directions, by file
    std::optional<std::regex> regex_;
    std::map<std::string, std::size_t> index_;
};

std::string since_words(const CarrierDiagnosis& d, const Change& change) {
    return d.cars[change.first_car].utc.substr(0, 16);
}

// Where it is: "carrier 7", "fixture", "all carriers".
Text place_words(const CarrierDiagnosis& d, const Change& change) {
    if (d.carriers.size() == 1 && d.carriers.front().empty()) return "the fixture";
    if (change.what == Moved::cell) return "all carriers";
    return Text("carrier {}", d.carriers[change.carrier]);
}

// The elements that the change may be of: the most probable, and those that so many cars do not tell from it.
std::vector<const ElementMoved*> suspects(const Change& change) {
    std::vector<const ElementMoved*> list;
    for (const ElementMoved& e : change.elements)
        if (list.empty() || e.probability > 0.05) list.push_back(&e);
    return list;
}

Text sentence_of(const CarrierDiagnosis& d, const Change& change) {
    const Text place = place_words(d, change);
    const Text when = change.how == MovedBy::step
                          ? Text("since {} UTC (run {}, part {})", since_words(d, change),
                                 d.cars[change.first_car].run, d.cars[change.first_car].part)
                          : Text("little by little since {} UTC", since_words(d, change));
    if (change.elements.empty() && change.what == Moved::cell)
        return Text("{} {}: no carrier's locator, but robot, sensor or the place of the work object: {}",
                    place, when, motion_words(change.motion));
    if (change.elements.empty()) return Text("{} {}: {}", place, when, motion_words(change.motion));
    const auto list = suspects(change);
    const ElementMoved& first = *list.front();
    const FixtureElement& element = d.fixture->elements[first.element];
    if (change.several > first.probability)
        return Text("{} {}: no single element explains it ({}), {:.0f} %", place, when,
                    motion_words(change.motion), percent(change.several));
    if (list.size() == 1)
        return Text("{}: {}, {} {}, {:.0f} %", place, element.id, amounts(element, first), when,
                    percent(first.probability));
    std::string others;
    for (std::size_t i = 1; i < list.size(); ++i)
        others += fmt::format("{}{} ({:.0f} %)", i > 1 ? ", " : "", d.fixture->elements[list[i]->element].id,
                              100 * list[i]->probability);
    return Text("{}: {}, {} {}, {:.0f} %; or {}, which these cars do not tell apart from it", place,
                element.id, amounts(element, first), when, percent(first.probability), others);
}

std::vector<NotTold> not_told(const Fixture& fixture, std::span<const Pattern> patterns,
                              const Matrix6& car_covariance) {
    std::vector<NotTold> list;
    for (std::size_t i = 0; i < patterns.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
            const double cars =
                std::max(cars_to_tell_apart(patterns[i], patterns[j], car_covariance, kToldMm),
                         cars_to_tell_apart(patterns[j], patterns[i], car_covariance, kToldMm));
            if (cars > kManyCars) list.push_back({fixture.elements[j].id, fixture.elements[i].id, cars});
        }
    std::ranges::stable_sort(list, std::greater<>{}, &NotTold::cars);
    return list;
}

}  // namespace

Expected<Fixture> fixture_from_json(const nlohmann::json& json, const std::string& where) {
    SEAM_OK(only_fields(json, {"elements", "carrier_pattern"}, where));
    Fixture fixture;
    SEAM_TRY(const auto* elements, json_array(json, "elements", where));
    std::set<std::string> ids;
    for (std::size_t i = 0; i < elements->size(); ++i) {
        const std::string at = json_path(json_path(where, "elements"), i);
        SEAM_TRY(auto element, element_from((*elements)[i], at));
        if (!ids.insert(element.id).second)
            return input_error(Text("two elements of the fixture are called \"{}\"", element.id), at,
                               "rename one");
        fixture.elements.push_back(std::move(element));
    }
    SEAM_TRY(fixture.carrier_pattern, json_string_or(json, "carrier_pattern", "", where));
    if (!fixture.carrier_pattern.empty()) SEAM_OK(pattern_from(fixture.carrier_pattern));
    if (!fixture.elements.empty()) SEAM_OK(patterns_of(fixture));
    return fixture;
}

Expected<std::vector<Pattern>> patterns_of(const Fixture& fixture) {
    std::vector<HoldingElement> elements;
    for (const FixtureElement& e : fixture.elements) {
        SEAM_TRY(auto directions, unit_directions(e.directions, e.id));
        elements.push_back({e.at_mm, std::move(directions)});
    }
    auto patterns = fixture_patterns(elements);
    if (patterns.status == FixtureStatus::loose)
        return input_error(
            Text("the fixture leaves the part free to move ({})", motion_words(patterns.free_motion)),
            fixture.id, "name every locator and pin: six directions in all hold a part");
    return std::move(patterns.elements);
}

Expected<std::map<std::string, std::string>> read_carriers(const std::string& text,
                                                           const std::string& where) {
    std::map<std::string, std::string> carriers;
    std::size_t line = 0;
    for (std::size_t at = 0; at < text.size();) {
        const auto end = std::min(text.find('\n', at), text.size());
        std::string row = text.substr(at, end - at);
        at = end + 1;
        ++line;
        if (line == 1 && row.starts_with("\xef\xbb\xbf")) row.erase(0, 3);
        if (!row.empty() && row.back() == '\r') row.pop_back();
        if (row.empty()) continue;
        const auto comma = row.find_first_of(",;\t");
        if (comma == std::string::npos || comma == 0 || comma + 1 == row.size())
            return input_error("a line does not name a part and its carrier",
                               Text("{}, line {}", where, line), "write: part,carrier");
        const std::string part = row.substr(0, comma), carrier = row.substr(comma + 1);
        if (line == 1) {
            if (part != "part" || carrier != "carrier")
                return input_error("the first line does not say part,carrier", where,
                                   "give the list this header");
            continue;
        }
        if (const auto [it, made] = carriers.emplace(part, carrier); !made && it->second != carrier)
            return input_error(Text("part {} is in two carriers", part), Text("{}, line {}", where, line),
                               "name each part once");
    }
    if (carriers.empty()) return input_error("the list names no part", where, "give lines of part,carrier");
    return carriers;
}

Expected<CarrierDiagnosis> diagnose_production(const Production& production,
                                               const CarrierDiagnosisOptions& options) {
    CarrierDiagnosis out;
    SEAM_TRY(const auto cars, Collecting(production, options, out).cars());
    std::vector<Pattern> patterns;
    if (out.fixture && !out.fixture->elements.empty()) {
        SEAM_TRY(patterns, patterns_of(*out.fixture));
    }
    DiagnosisOptions how;
    how.alarm = options.alarm;
    how.one_fixture = out.carriers.size() == 1 && out.carriers.front().empty();
    out.numbers = diagnose(cars, std::max<std::size_t>(out.carriers.size(), 1), patterns, how);
    if (out.numbers.status == DiagnosisStatus::too_few) {
        out.verdict = Text("too few cars: {} of the same carrier after another, {} are needed",
                           out.numbers.differences, kFewestDifferences);
        return out;
    }
    if (!patterns.empty()) out.not_told = not_told(*out.fixture, patterns, out.numbers.car_covariance);
    for (const Change& change : out.numbers.changes) out.sentences.push_back(sentence_of(out, change));
    out.verdict = out.changed()
                      ? Text("{} of what holds or measures the parts has moved", out.numbers.changes.size())
                      : Text("nothing has moved in {} cars", out.numbers.cars);
    return out;
}

}  // namespace seamwright
