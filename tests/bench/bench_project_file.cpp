// Raw profiles into the project file: packed blocks against one row a profile in plain SQLite, both durable,
// same disk.

#include <benchmark/benchmark.h>
#include <sqlite3.h>

#include <chrono>
#include <cstdio>

#include "projects/file/project_file.h"
#include "tests/projects/sample_project.h"

namespace {

using namespace seamwright;

constexpr int kProfiles = 2000, kPoints = 1000;

const RunRecord& recorded_run() {
    static const RunRecord run = [] {
        SampleMaker make(1);
        RunRecord r;
        r.part_id = "bench";
        for (int i = 0; i < kProfiles; ++i) {
            Capture c;
            c.spot_id = "S1";
            c.sensor_id = "A";
            c.sequence = static_cast<std::uint64_t>(i);
            c.profile = make.profile(kPoints, false);
            r.captures.push_back(std::move(c));
        }
        return r;
    }();
    return run;
}

// Profiles a second; the best of a few, since the disk is shared.
double packed() {
    TemporaryFolder folder;
    auto file = ProjectFile::create(folder / "a.seam", Project{});
    if (!file) return 0;
    const auto start = std::chrono::steady_clock::now();
    if (!file->append_run(recorded_run(), Project{})) return 0;
    return kProfiles / std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double one_row_each() {
    TemporaryFolder folder;
    sqlite3* db = nullptr;
    sqlite3_open((folder / "b.sqlite").c_str(), &db);
    sqlite3_exec(
        db,
        "PRAGMA synchronous = FULL; CREATE TABLE points (profile INTEGER, sequence INTEGER, x BLOB, z BLOB)",
        nullptr, nullptr, nullptr);
    sqlite3_stmt* insert = nullptr;
    sqlite3_prepare_v2(db, "INSERT INTO points VALUES (?, ?, ?, ?)", -1, &insert, nullptr);
    const auto start = std::chrono::steady_clock::now();
    // A commit a hundred profiles: what a recorder that must not lose more than 0.1 s would do.
    for (int i = 0; i < kProfiles; ++i) {
        if (i % 100 == 0) sqlite3_exec(db, i ? "COMMIT; BEGIN" : "BEGIN", nullptr, nullptr, nullptr);
        const Capture& c = recorded_run().captures[static_cast<std::size_t>(i)];
        sqlite3_bind_int(insert, 1, i);
        sqlite3_bind_int64(insert, 2, static_cast<sqlite3_int64>(c.sequence));
        sqlite3_bind_blob(insert, 3, c.profile.x_mm.data(), static_cast<int>(8 * c.profile.size()),
                          SQLITE_STATIC);
        sqlite3_bind_blob(insert, 4, c.profile.z_mm.data(), static_cast<int>(8 * c.profile.size()),
                          SQLITE_STATIC);
        sqlite3_step(insert);
        sqlite3_reset(insert);
    }
    sqlite3_exec(db, "COMMIT", nullptr, nullptr, nullptr);
    const double rate =
        kProfiles / std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    sqlite3_finalize(insert);
    sqlite3_close(db);
    return rate;
}

void BM_AppendProfiles(benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(packed());
    state.SetItemsProcessed(state.iterations() * kProfiles);
}
BENCHMARK(BM_AppendProfiles)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_LoadProfiles(benchmark::State& state) {
    TemporaryFolder folder;
    auto file = ProjectFile::create(folder / "a.seam", Project{});
    if (!file || !file->append_run(recorded_run(), Project{}))
        return state.SkipWithError("the file cannot be written");
    for (auto _ : state) benchmark::DoNotOptimize(file->load_run(1));
    state.SetItemsProcessed(state.iterations() * kProfiles);
}
BENCHMARK(BM_LoadProfiles)->Unit(benchmark::kMillisecond)->UseRealTime();

// A run as the station stores it on a line that pushes: begun, what was measured, judged with its events, the
// outcome. What a robot waits for is the disk and this.
void BM_CommittedRun(benchmark::State& state) {
    TemporaryFolder folder;
    const Project project = sample_project();
    auto file = ProjectFile::create(folder / "a.seam", project);
    const auto setup = RunSetup::of(project);
    if (!file || !setup) return state.SkipWithError("the file cannot be written");
    file->keep_write_ahead(true);
    RunRecord run = sample_run(1, 12, 300);
    for (auto _ : state) {
        const auto number = file->begin_run(run, *setup);
        if (!number) return state.SkipWithError("the run cannot be stored");
        run.number = *number;
        StoredMeasurements stored;
        const bool kept = file->append_measured(run, stored) && file->finish_run(run, stored) &&
                          file->append_event({0, "", run.number, EventKind::push, "edge", "written"}) &&
                          file->update_run(run);
        if (!kept) return state.SkipWithError("the run cannot be stored");
    }
}
BENCHMARK(BM_CommittedRun)->Unit(benchmark::kMicrosecond)->UseRealTime();

// A file of a day: a thousand runs.
void BM_Open(benchmark::State& state) {
    TemporaryFolder folder;
    const Project project = sample_project();
    {
        auto file = ProjectFile::create(folder / "a.seam", project);
        if (!file) return state.SkipWithError("the file cannot be written");
        file->keep_write_ahead(true);
        const RunRecord run = sample_run(1, 12, 300);
        for (int i = 0; i < 1000; ++i)
            if (!file->append_run(run, project)) return state.SkipWithError("the run cannot be stored");
    }
    for (auto _ : state) {
        const auto file = ProjectFile::open(folder / "a.seam", FileAccess::read_only);
        if (!file || !file->load()) return state.SkipWithError("the file cannot be opened");
    }
}
BENCHMARK(BM_Open)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    benchmark::RunSpecifiedBenchmarks();
    double ours = 0, peer = 0;
    for (int i = 0; i < 5; ++i) {
        ours = std::max(ours, packed());
        peer = std::max(peer, one_row_each());
    }
    std::printf("project_file_profiles_per_s: %.0f (%d points each, committed)\n", ours, kPoints);
    std::printf("ratio project_file_vs_row_per_profile: %.1fx\n", ours / peer);
}
