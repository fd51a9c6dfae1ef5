#include "projects/statistics/shift_report.h"

#include <fmt/chrono.h>

#include <chrono>
#include <condition_variable>
#include <ctime>
#include <mutex>

#include "core/system_text.h"
#include "devices/exchange/files.h"
#include "projects/statistics/statistics_page.h"

namespace seamwright {
namespace {

std::int64_t now_s() {
    return std::chrono::duration_cast<std::chrono::seconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
}

std::int64_t ahead_of_utc(std::int64_t at_s) {
    const auto t = static_cast<std::time_t>(at_s);
    std::tm local{};
    localtime_r(&t, &local);
    return local.tm_gmtoff;
}

}  // namespace

Shift shift_at(std::int64_t at_s, std::int64_t local_s, const ShiftReportOptions& options) {
    const std::int64_t local = at_s + local_s - options.first_s;
    const std::int64_t rest = ((local % options.every_s) + options.every_s) % options.every_s;
    return {at_s - rest, at_s - rest + options.every_s};
}

std::filesystem::path shift_report_path(const Shift& shift, const ShiftReportOptions& options) {
    const auto t = static_cast<std::time_t>(shift.from_s);
    std::tm local{};
    localtime_r(&t, &local);
    return options.folder / fmt::format("{}_{:%Y-%m-%dT%H%M%S}.html", options.file.stem().string(), local);
}

Expected<std::filesystem::path> write_shift_report(const Shift& shift, const ShiftReportOptions& options) {
    StatisticsOptions wanted = options.statistics;
    wanted.runs = {utc_text(shift.from_s), utc_text(shift.until_s)};
    SEAM_TRY(auto statistics, production_statistics({options.file}, wanted));
    std::error_code error;
    std::filesystem::create_directories(options.folder, error);
    if (error)
        return file_error(Text("the folder cannot be made: {}", system_text(error)), options.folder.string(),
                          "choose a folder that can be written to");
    const auto path = shift_report_path(shift, options);
    auto json_path = path;
    json_path.replace_extension(".json");
    SEAM_OK(write_text_file(json_path, statistics_json(statistics).dump(2) + "\n"));
    const auto page = statistics_page(statistics, options.language, options.program);
    SEAM_OK(write_text_file(path, page.html()));
    return path;
}

ShiftReports::ShiftReports(ShiftReportOptions options)
    : options_(std::move(options)), thread_([this](const std::stop_token& stop) { run(stop); }) {}

void ShiftReports::run(const std::stop_token& stop) {
    const auto report = [&](const Shift& shift) {
        auto path = write_shift_report(shift, options_);
        if (path && options_.written) options_.written(*path);
        if (!path && options_.failed) options_.failed(path.error());
    };
    Shift now = shift_at(now_s(), ahead_of_utc(now_s()), options_);
    const Shift before{now.from_s - options_.every_s, now.from_s};
    std::error_code ignored;
    if (!std::filesystem::exists(shift_report_path(before, options_), ignored)) {
        const auto production =
            production_of({options_.file}, {utc_text(before.from_s), utc_text(before.until_s)});
        if (production && !production->runs.empty()) report(before);
    }
    std::mutex mutex;
    std::condition_variable_any wake;
    std::unique_lock lock(mutex);
    while (!stop.stop_requested()) {
        // In steps: the wall clock may be set meanwhile.
        wake.wait_for(lock, stop, std::chrono::milliseconds(250), [] { return false; });
        if (stop.stop_requested() || now_s() < now.until_s) continue;
        report(now);
        now = shift_at(now_s(), ahead_of_utc(now_s()), options_);
    }
}

}  // namespace seamwright
