#pragma once
// A capture: a recorded session of sensors and robots in one SQLite file (*.seam).
//
// Identity: application_id "SeaC" (0x53656143; a project has "Seam"), user_version = kCaptureVersion. Opening
// refuses, with one sentence (ErrorKind::file): no SQLite database, a project, another program's, a newer
// version's, one cut short or with other tables than ours. It reads the table of blocks and no block: what
// lies inside a block is covered by its checksum, which every reading holds against it.
//
// Tables: `capture` one row (when, how it ended); `sources` one row a sensor or robot with identity and
// counters; `blocks` the frames, about 1 MiB of them a row in the form of profile_blob.h, as they are
// (unpacked = 0) or in zlib's form (unpacked = bytes before); `spots` which frames were taken for a spot;
// `events` triggers, poses and modes of robots, and notes (a source that failed, and why).
//
// Crash safety: rollback journal, synchronous = FULL. A process killed at any instant leaves every committed
// block; the next open rolls back what was under way.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "devices/capture/capture.h"
#include "devices/capture/sqlite.h"

namespace seamwright {

inline constexpr std::int32_t kCaptureVersion = 1;

enum class SourceKind { sensor, robot };

struct CaptureCounters {
    std::uint64_t frames = 0;   // in the file
    std::uint64_t damaged = 0;  // of these, with a status other than ok
    std::uint64_t lost = 0;     // before the recorder: gaps of the source's sequence
    std::uint64_t dropped = 0;  // by the recorder: the disk was too slow, or failed
};

struct CaptureSource {
    std::int64_t id = 0;  // given by the file
    SourceKind kind = SourceKind::sensor;
    std::string name;  // the id it has in the project
    // Of SensorIdentity, or of RobotIdentity with its brand as vendor.
    std::string driver, vendor, model, serial;
    CaptureCounters counters;
    std::int64_t first_host_ns = 0, last_host_ns = 0;  // of its frames
};

enum class CaptureEventKind { trigger, pose, mode, note };
std::string_view to_string(CaptureEventKind kind);

struct CaptureEvent {
    std::int64_t source = 0;
    CaptureEventKind kind = CaptureEventKind::note;
    std::int64_t host_time_ns = 0;
    std::string spot_id;                   // trigger
    std::string text;                      // mode: its name; note: what happened
    std::optional<Pose> base_from_flange;  // trigger, pose
};

// Writes one file. One thread at a time. After an Error of kind file nothing more can be written; what was
// committed stays.
class CaptureWriter {
  public:
    // Refuses an existing file. `limit_bytes` > 0 ends the recording there as a full disk would.
    static Expected<CaptureWriter> create(const std::filesystem::path& path, std::uint64_t limit_bytes = 0);

    // `name` must be new.
    Expected<std::int64_t> add_source(const CaptureSource& source);

    struct Block {
        std::int64_t source = 0;
        std::uint64_t first = 0;  // number of its first frame, counted from 0 for each source
        int frames = 0;
        std::int64_t first_host_ns = 0, last_host_ns = 0;
        std::span<const std::byte> bytes;
        std::size_t unpacked = 0;                                  // bytes before zlib, 0 = not packed
        std::vector<std::pair<std::uint64_t, std::string>> spots;  // frame number, spot id
    };
    // All in one transaction.
    Expected<void> write(std::span<const Block> blocks, std::span<const CaptureEvent> events,
                         const std::map<std::int64_t, CaptureCounters>& counters);
    // The orderly end; `how` in words ("stopped").
    Expected<void> finish(const std::string& how);
    const std::filesystem::path& path() const { return path_; }

  private:
    CaptureWriter(std::filesystem::path path, Database db) : path_(std::move(path)), db_(std::move(db)) {}
    std::filesystem::path path_;
    Database db_;
};

// One thread at a time.
class CaptureReader {
  public:
    static Expected<CaptureReader> open(const std::filesystem::path& path);

    const std::filesystem::path& path() const { return path_; }
    const std::string& started_utc() const { return started_utc_; }
    const std::string& finished_utc() const { return finished_utc_; }  // empty: killed, or still recording
    const std::string& end() const { return end_; }
    const std::vector<CaptureSource>& sources() const { return sources_; }
    // nullptr when there is none of that name and kind. An empty name is the only source of the kind.
    const CaptureSource* find(const std::string& name, SourceKind kind) const;
    // From the first frame to the last of any source.
    double duration_s() const;

    // Frame `number` (0 ..) of a source; valid until the next call for the same source. Reading in order
    // reads each block once. Error: past the end, or a damaged block.
    std::uint64_t frames(std::int64_t source) const;
    Expected<const Capture*> frame(std::int64_t source, std::uint64_t number);
    // The frames of a source that were taken for a spot, in order.
    Expected<std::vector<std::pair<std::uint64_t, std::string>>> spots(std::int64_t source);
    // In order of time. source 0 = all.
    Expected<std::vector<CaptureEvent>> events(std::int64_t source = 0);
    // The long check: SQLite's own, and every block. Empty = sound.
    std::vector<Error> check();

  private:
    struct BlockRow {
        std::int64_t id = 0, source = 0;
        std::uint64_t first = 0;  // position among the frames that are in the file
        int frames = 0;
        std::size_t unpacked = 0;
    };
    struct Decoded {
        std::int64_t block = 0;
        std::vector<Capture> frames;
    };
    CaptureReader(std::filesystem::path path, Database db) : path_(std::move(path)), db_(std::move(db)) {}
    Expected<void> read_tables();
    Expected<void> decode(const BlockRow& row, std::vector<Capture>& frames);

    std::filesystem::path path_;
    Database db_;
    std::string started_utc_, finished_utc_, end_;
    std::vector<CaptureSource> sources_;
    std::map<std::int64_t, std::vector<BlockRow>> blocks_;  // by source
    std::map<std::int64_t, Decoded> decoded_;               // by source
};

// Which of our files this is, by its application_id alone: so that a command can take either.
enum class SeamFile { project, capture, other };
SeamFile seam_file_kind(const std::filesystem::path& path);

}  // namespace seamwright
