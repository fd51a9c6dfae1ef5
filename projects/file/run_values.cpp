#include "projects/file/run_values.h"

#include <unordered_map>

#include "devices/exchange/pose_json.h"
#include "projects/file/project_file_detail.h"
#include "projects/file/project_json.h"
#include "projects/file/row_checksum.h"
#include "projects/file/stored_text.h"

namespace seamwright {
namespace {

constexpr const char* kWhichRuns =
    "started_utc >= ?1 AND (?2 = '' OR started_utc < ?2) AND (?3 = '' OR EXISTS (SELECT 1 FROM run_types "
    "WHERE "
    "run_types.run = number AND type_id = ?3))";

constexpr const char* kThisRun = "number = ?5";

class ValuesReader {
  public:
    ValuesReader(Database& db, const RunValuesWanted& wanted) : db_(db), wanted_(wanted) {}

    Expected<std::vector<RunValues>> read() {
        for (const char* table : {"runs", "run_regions", "run_panels", "run_types"}) {
            const char* key = std::string_view(table) == "runs" ? "number" : "run";
            SEAM_OK(check_rows(db_, table, wanted_.run ? key : nullptr, wanted_.run));
        }
        const auto regions = [&](Statement& row) { return region(row); };
        const auto panels = [&](Statement& row) { return panel(row); };
        const auto spots = [&](Statement& row) { return spot(row); };
        for (Expected<void> done :
             {query("SELECT number, part_id, started_utc, finished_utc, push, status, setup, "
                    "ifnull((SELECT type_id FROM run_types WHERE run = number), ''), message FROM runs WHERE "
                    "{} ORDER "
                    "BY number",
                    [&](Statement& row) { return run(row); }),
              query("SELECT run, region_id, run_regions.gate_passed, "
                    "ifnull(json_extract(body, '$.correction.status'), ''), "
                    "ifnull(json_extract(body, '$.correction.workobject_from_movedworkobject'), ''), "
                    "CASE run_regions.gate_passed WHEN 1 THEN '[]' "
                    "ELSE ifnull(json_extract(body, '$.refusals'), '[]') END, "
                    "CASE ?4 WHEN 1 THEN ifnull(json_extract(body, '$.correction.covariance_random'), "
                    "ifnull(json_extract(body, '$.correction.covariance'), '')) ELSE '' END, "
                    "CASE ?6 WHEN 1 THEN ifnull(json_extract(body, '$.correction.sigma_xyz_mm'), '') ELSE '' "
                    "END, "
                    "CASE ?6 WHEN 1 THEN ifnull(json_extract(body, '$.correction.sigma_abc_deg'), '') ELSE "
                    "'' END "
                    "FROM run_regions JOIN runs ON run = number WHERE {} ORDER BY run, position",
                    regions),
              query("SELECT run, job_id, run_panels.gate_passed, "
                    "ifnull(json_extract(body, '$.before'), '[]'), ifnull(json_extract(body, '$.after'), "
                    "'[]'), ifnull(json_extract(body, '$.refusals'), '[]') "
                    "FROM run_panels JOIN runs ON run = number WHERE {} ORDER BY run",
                    panels),
              query("SELECT run, spot_id, run_spots.status FROM run_spots JOIN runs ON run = number "
                    "WHERE run_spots.status <> 'measured' AND {} ORDER BY run, position",
                    spots)})
            if (!done) return tl::unexpected(done.error());
        return std::move(runs_);
    }

  private:
    template <class Read>
    Expected<void> query(const char* sql, const Read& read) {
        SEAM_TRY(auto s, db_.prepare(fmt::format(fmt::runtime(sql), wanted_.run ? kThisRun : kWhichRuns)));
        s.bind(1, wanted_.since_utc);
        s.bind(2, wanted_.until_utc);
        s.bind(3, wanted_.type_id);
        s.bind(4, std::int64_t{wanted_.covariances});  // of the one statement that asks for it
        s.bind(5, wanted_.run);
        s.bind(6, std::int64_t{wanted_.sigmas});
        return for_each_row(s, read);
    }

    Expected<void> wrong(std::int64_t number) const {
        return file_error("an entry of the project file cannot be read",
                          Text("{}: run {}", db_.path(), number));
    }

    Expected<void> run(Statement& row) {
        RunValues r;
        r.number = row.integer(0);
        r.part_id = row.text(1);
        r.started_utc = row.text(2);
        r.finished_utc = row.text(3);
        r.push = row.integer(4) != 0;
        const auto status = run_status_from(row.text(5));
        if (!status) return wrong(r.number);
        r.status = *status;
        r.setup = row.integer(6);
        r.type_id = row.text(7);
        r.message = text_from_stored(row.text(8));
        at_.emplace(r.number, runs_.size());
        runs_.push_back(std::move(r));
        return {};
    }

    // Another process may have appended runs since the first query: those are left to the next reading.
    RunValues* run_of(std::int64_t number) {
        const auto at = at_.find(number);
        return at == at_.end() ? nullptr : &runs_[at->second];
    }

    std::optional<std::vector<Text>> refusals(const std::string& stored) const {
        const auto list = parse_json(stored, "refusals");
        if (!list || !list->is_array()) return std::nullopt;
        std::vector<Text> out;
        for (const auto& item : *list) {
            auto text = text_from_json(item);
            if (!text) return std::nullopt;
            out.push_back(std::move(*text));
        }
        return out;
    }

    static bool three(const std::string& stored, double* to) {
        const auto numbers = parse_json(stored, "sigma");
        if (!numbers) return false;
        const auto read = as_numbers(*numbers, 3, "sigma");
        if (read) std::copy(read->begin(), read->end(), to);
        return read.has_value();
    }

    Expected<void> region(Statement& row) {
        RunValues* of = run_of(row.integer(0));
        if (!of) return {};
        RegionValue r;
        r.region_id = row.text(1);
        r.gate_passed = row.integer(2) != 0;
        const std::string status = row.text(3), pose = row.text(4);
        if (auto said = refusals(row.text(5)))
            r.refusals = std::move(*said);
        else
            return wrong(of->number);
        if (!status.empty()) {
            r.status = correction_status_named(status);
            if (!r.status) return wrong(of->number);
        }
        if (r.status == CorrectionStatus::ok || r.status == CorrectionStatus::over_limit) {
            const auto document = parse_json(pose, "displacement");
            auto parsed = document ? parse_pose(*document, "displacement")
                                   : Expected<Pose>(tl::unexpected(document.error()));
            if (!parsed) return wrong(of->number);
            r.workobject_from_movedworkobject = *parsed;
            if (const std::string covariance = row.text(6); !covariance.empty()) {
                const auto numbers = parse_json(covariance, "covariance");
                auto read = numbers ? as_numbers(*numbers, 36, "covariance")
                                    : Expected<std::vector<double>>(tl::unexpected(numbers.error()));
                if (!read) return wrong(of->number);
                r.covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(read->data());
            }
            if (const std::string xyz = row.text(7), abc = row.text(8); !xyz.empty() && !abc.empty()) {
                r.sigma.emplace();
                if (!three(xyz, r.sigma->data()) || !three(abc, r.sigma->data() + 3)) r.sigma.reset();
            }
        }
        of->regions.push_back(std::move(r));
        return {};
    }

    static bool places(const std::string& stored, std::vector<PlaceValue>& out) {
        const auto list = parse_json(stored, "places");
        if (!list || !list->is_array()) return false;
        for (const auto& item : *list) {
            auto place = from_json_document<PanelMeasurement>(item, "place", kResult.archive);
            if (!place) return false;
            if (place->status == SpotStatus::measured)
                out.push_back({place->place_id, place->gap_mm, place->flush_mm});
        }
        return true;
    }

    Expected<void> panel(Statement& row) {
        RunValues* of = run_of(row.integer(0));
        if (!of) return {};
        PanelValue p;
        p.job_id = row.text(1);
        p.gate_passed = row.integer(2) != 0;
        auto said = refusals(row.text(5));
        if (!places(row.text(3), p.before) || !places(row.text(4), p.after) || !said)
            return wrong(of->number);
        p.refusals = std::move(*said);
        of->panel = std::move(p);
        return {};
    }

    Expected<void> spot(Statement& row) {
        RunValues* of = run_of(row.integer(0));
        if (!of) return {};
        const std::string id = row.text(1), status = row.text(2);
        for (const SpotStatus s : {SpotStatus::not_measured, SpotStatus::damaged_frame, SpotStatus::no_stripe,
                                   SpotStatus::no_calibration, SpotStatus::no_feature})
            if (to_string(s) == status) {
                of->not_measured.emplace_back(id, s);
                return {};
            }
        return wrong(of->number);
    }

    Database& db_;
    const RunValuesWanted& wanted_;
    std::vector<RunValues> runs_;
    std::unordered_map<std::int64_t, std::size_t> at_;
};

}  // namespace

Expected<std::vector<RunValues>> ProjectFile::run_values(const RunValuesWanted& wanted) const {
    return ValuesReader(impl_->db, wanted).read();
}

}  // namespace seamwright
