// seamwright scan: a pass over the part as a cloud, in a file or kept with the project.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <span>

#include "app/cli/arguments/pose_table_arguments.h"
#include "app/cli/command.h"
#include "app/cli/sign_in.h"
#include "app/cli/signal_watch.h"
#include "devices/exchange/cloud/cloud_file.h"
#include "devices/exchange/tables/point_table.h"
#include "devices/exchange/tables/pose_table.h"
#include "projects/scan/scan.h"

namespace seamwright::cli {
namespace {

using nlohmann::json;

struct ScanArguments {
    std::string file, capture, out, path, keep, kept, remove;
    PoseTableArguments poses;
    std::int64_t run = 0;
    bool follow = false, list = false;
    RecordedGapPass recorded;
    DrivenGapPass driven;
    FollowedPass followed;
    double cell_mm = 0;
    bool keep_outliers = false;

    bool with_devices() const { return follow || !path.empty() || !driven.spot_ids.empty(); }
};

void tell_progress(const RunProgress& p) {
    if (p.done == p.total || p.done % 50 == 0)
        fmt::print(stderr, "{}\n", p.total > 0 ? fmt::format("[{}/{}]", p.done, p.total) : p.text.english());
}

// How the scan was made, for the list.
std::string path_words(const ScanArguments& a) {
    if (a.follow) return "followed";
    if (!a.path.empty()) return "poses " + a.path;
    if (!a.driven.spot_ids.empty()) return fmt::format("spots {}", fmt::join(a.driven.spot_ids, ", "));
    return a.run > 0 ? fmt::format("run {}", a.run) : "capture " + a.capture;
}

Expected<ScanResult> scanned_by_devices(ScanArguments& a) {
    if (!a.path.empty()) {
        SEAM_TRY(const auto layout, a.poses.layout());
        SEAM_TRY(const auto table, read_pose_table(a.path, layout));
        for (const TablePose& p : table.poses) a.driven.stands.push_back(p.pose);
    }
    SEAM_TRY(auto station, open_station(a.file));
    if (a.recorded.robot_id.empty() && station.project().robots.size() == 1)
        a.recorded.robot_id = station.project().robots.front().id;
    SEAM_OK(station.connect());
    a.driven.cancel = a.followed.cancel = stop_on_signal();
    a.driven.progress = a.followed.progress = tell_progress;
    a.followed.step_mm = a.driven.step_mm;
    a.driven.sensor_id = a.followed.sensor_id = a.recorded.sensor_id;
    a.driven.robot_id = a.followed.robot_id = a.recorded.robot_id;
    SEAM_TRY(auto pass, a.follow ? followed_pass(station, a.followed) : gap_pass(station, a.driven));
    return scan_of_pass(station.project(), pass);
}

Expected<ScanResult> scanned(ScanArguments& a) {
    if (a.with_devices()) return scanned_by_devices(a);
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    if (a.run > 0) return scan_of_run(file, a.run);
    if (a.capture.empty())
        return usage_error(
            "there is nothing to make a scan of", a.file,
            "give --path POSES.csv or --spots S1,S2 to drive along, --follow, --capture PASS.seam, "
            "or --run N");
    SEAM_TRY(auto project, file.load());
    SEAM_TRY(auto capture, CaptureReader::open(a.capture));
    SEAM_TRY(auto pass, gap_pass(project, capture, a.recorded));
    return scan_of_pass(project, pass);
}

json scan_row(const StoredScan& s) {
    return {{"name", s.name},         {"utc", s.utc},   {"sensor", s.sensor_id}, {"robot", s.robot_id},
            {"profiles", s.profiles}, {"path", s.path}, {"points", s.points}};
}

Expected<Answer> list_scans(const std::string& path) {
    SEAM_TRY(auto file, ProjectFile::open(path, FileAccess::read_only));
    SEAM_TRY(const auto scans, file.scans());
    Answer answer;
    answer.json = {{"status", "ok"}, {"scans", json::array()}};
    for (const StoredScan& s : scans) {
        answer.json["scans"].push_back(scan_row(s));
        answer.text +=
            fmt::format("{}  {}  {} points, {} profiles, {}\n", s.name, s.utc, s.points, s.profiles, s.path);
    }
    if (scans.empty()) answer.text = "no scan is kept in it\n";
    return answer;
}

Expected<Answer> write_kept(const ScanArguments& a) {
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(const auto scan, file.load_scan(a.kept));
    SEAM_TRY(const auto cloud,
             parse_cloud({reinterpret_cast<const char*>(scan.cloud_ply.data()), scan.cloud_ply.size()},
                         a.file + ": " + a.kept, "mm"));
    SEAM_OK(write_cloud(a.out, cloud, kInBaseMark));
    Answer answer{scan_row(scan),
                  fmt::format("{} written: {} points in the robot's base\n", a.out, cloud.size())};
    answer.json["status"] = "ok";
    answer.json["out"] = a.out;
    return answer;
}

Expected<Answer> remove_kept(const ScanArguments& a) {
    SEAM_TRY(auto file, open_to_edit(a.file));
    SEAM_OK(file.delete_scan(a.remove));
    return Answer{{{"status", "ok"}, {"removed", a.remove}}, fmt::format("{} removed\n", a.remove)};
}

// Before a robot moves: what would be refused afterwards.
Expected<void> name_is_free(const ScanArguments& a) {
    if (a.keep.empty()) return {};
    SEAM_TRY(auto file, ProjectFile::open(a.file, FileAccess::read_only));
    SEAM_TRY(const auto scans, file.scans());
    for (const StoredScan& s : scans)
        if (s.name == a.keep)
            return input_error(Text("the project has a scan \"{}\" already", a.keep), a.file,
                               "give another name");
    return {};
}

Expected<void> keep_scan(const ScanArguments& a, const ScanResult& scan) {
    StoredScan kept;
    kept.name = a.keep;
    kept.sensor_id = scan.sensor_id;
    kept.robot_id = a.recorded.robot_id;
    kept.path = path_words(a);
    kept.profiles = static_cast<std::int64_t>(scan.profiles);
    kept.points = static_cast<std::int64_t>(scan.cloud.size());
    const std::string ply = cloud_ply(scan.cloud, kInBaseMark);
    const auto bytes = std::as_bytes(std::span(ply));
    kept.cloud_ply.assign(bytes.begin(), bytes.end());
    SEAM_TRY(auto file, open_to_edit(a.file));
    return file.append_scan(kept);
}

Expected<Answer> make_scan(ScanArguments& a) {
    if (a.out.empty() && a.keep.empty())
        return usage_error("the scan would be lost", a.file, "give --out FILE.ply, or --keep NAME, or both");
    SEAM_OK(name_is_free(a));
    SEAM_TRY(auto scan, scanned(a));
    if (scan.cloud.empty())
        return input_error("no profile of the pass has a point", a.file,
                           "look at the sensor's picture on the way");
    if (a.keep_outliers)
        scan.cloud = a.cell_mm > 0 ? voxel_grid(scan.cloud, a.cell_mm) : std::move(scan.cloud);
    else
        clean(scan, a.cell_mm);
    estimate_normals(scan.cloud);
    if (!a.out.empty()) SEAM_OK(write_cloud(a.out, scan.cloud, kInBaseMark));
    if (!a.keep.empty()) SEAM_OK(keep_scan(a, scan));
    const Eigen::AlignedBox3d box = scan.cloud.box();
    const auto corner = [](const Eigen::Vector3d& v) { return json{v.x(), v.y(), v.z()}; };
    Answer answer;
    answer.json = {{"status", "ok"},
                   {"out", a.out.empty() ? json() : json(a.out)},
                   {"kept", a.keep.empty() ? json() : json(a.keep)},
                   {"frame", "base"},
                   {"path", path_words(a)},
                   {"profiles", scan.profiles},
                   {"without_profile", scan.without_profile},
                   {"without_pose", scan.without_pose},
                   {"travel_sigma_mm", scan.travel_sigma_mm},
                   {"points", scan.cloud.size()},
                   {"outliers", scan.outliers},
                   {"box", {{"from_mm", corner(box.min())}, {"to_mm", corner(box.max())}}}};
    answer.text = fmt::format("{} points of {} profiles in the robot's base, {} outliers left out\n",
                              scan.cloud.size(), scan.profiles, scan.outliers);
    if (scan.travel_sigma_mm > 0)
        answer.text += fmt::format(
            "the robot moved while the sensor exposed: up to {:.3f} mm unsure along its way "
            "(1 sigma)\n",
            scan.travel_sigma_mm);
    if (!a.out.empty()) answer.text += a.out + " written\n";
    if (!a.keep.empty()) answer.text += "kept in the project as " + a.keep + "\n";
    return answer;
}

Expected<Answer> scan_command(ScanArguments& a) {
    if (a.list) return list_scans(a.file);
    if (!a.remove.empty()) return remove_kept(a);
    if (!a.kept.empty()) {
        if (a.out.empty())
            return usage_error("there is no file to write the scan to", a.file, "give --out FILE.ply");
        return write_kept(a);
    }
    return make_scan(a);
}

void add_scan_options(CLI::App* command, const std::shared_ptr<ScanArguments>& a) {
    command->add_option("file", a->file, "The project")->required()->type_name("FILE.seam");
    add_sign_in(command);
    auto* spots =
        command->add_option("--spots", a->driven.spot_ids, "Spots that the robot goes along, in order");
    spots->delimiter(',')->type_name("S1,S2,...");
    auto* path = command->add_option("--path", a->path,
                                     "Poses of the flange in base that the robot goes along, in order, as "
                                     "`import` reads them");
    path->type_name("POSES.csv")->excludes(spots);
    auto* follow =
        command->add_flag("--follow", a->follow,
                          "Scan while the robot is moved by a person or its own program; nothing here "
                          "moves it");
    follow->excludes(spots)->excludes(path);
    command
        ->add_option("--rest-s", a->followed.rest_s,
                     "With --follow: ends when the robot has moved and rested so long")
        ->check(CLI::Range(0.2, 600.0))
        ->capture_default_str()
        ->needs(follow);
    command->add_option("--most-s", a->followed.most_s, "With --follow: ends at the latest")
        ->check(CLI::Range(0.1, 86400.0))
        ->capture_default_str()
        ->needs(follow);
    add_pose_table_options(command, a->poses, path);
    command->add_option("--step-mm", a->driven.step_mm, "Of the robot, from profile to profile")
        ->check(CLI::Range(0.05, 100.0))
        ->capture_default_str();
    auto* capture = command->add_option("--capture", a->capture, "A recorded pass: profiles and robot poses");
    capture->type_name("PASS.seam")->excludes(spots)->excludes(path)->excludes(follow);
    command->add_option("--run", a->run, "The profiles of a stored run")
        ->check(CLI::PositiveNumber)
        ->excludes(spots)
        ->excludes(path)
        ->excludes(follow)
        ->excludes(capture);
    command->add_option("--sensor", a->recorded.sensor_id, "Which one, when there are several")
        ->type_name("ID");
    command->add_option("--robot", a->recorded.robot_id, "Whose poses, when there are several")
        ->type_name("ID");
    command->add_option("--cell-mm", a->cell_mm, "One point a cell of this size; 0: every point")
        ->check(CLI::Range(0.0, 1000.0))
        ->capture_default_str();
    command->add_flag("--keep-outliers", a->keep_outliers,
                      "Without it points that stand far from all others are left out");
    command->add_option("--out", a->out, "The cloud, in the robot's base")->type_name("FILE.ply|.pcd|.csv");
    command->add_option("--keep", a->keep, "Keep it in the project")->type_name("NAME");
    auto* list = command->add_flag("--list", a->list, "The scans that the project keeps");
    auto* kept = command->add_option("--kept", a->kept, "Write one that the project keeps to --out");
    kept->type_name("NAME")->excludes(list);
    command->add_option("--remove", a->remove, "One that the project keeps")
        ->type_name("NAME")
        ->excludes(list)
        ->excludes(kept);
}

}  // namespace

void add_scan(CommandLine& line) {
    auto a = std::make_shared<ScanArguments>();
    CLI::App* command = line.add(
        "scan",
        "A cloud of points in the robot's base from a pass over the part: the robot goes from spot to spot, "
        "step by step "
        "(keep its\nway clear), or along poses, or is followed while something else moves it, or a recorded "
        "pass (`seamwright record`), or the profiles of a stored run.",
        "seamwright scan door_left.seam --spots T1,T2,T3 --step-mm 2 --out door.ply\n"
        "  seamwright scan door_left.seam --path poses.csv --step-mm 2 --keep first --out door.pcd\n"
        "  seamwright scan door_left.seam --follow --keep by-hand\n"
        "  seamwright scan door_left.seam --capture pass.seam --out door.pcd");
    add_scan_options(command, a);
    line.on(command, [a] { return scan_command(*a); });
}

}  // namespace seamwright::cli
