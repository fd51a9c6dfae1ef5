#pragma once
// A recording: a folder of profiles (CSV) or camera images with the robot poses they were taken at.
//
// What is found in the folder, the first that exists counts:
//   spots.json   {"frames":[{"file":"a.png","spot_id":"S1","base_from_flange":POSE | "pose_file":"a.txt"},
//   ..]} frames.csv   header file,spot_id[,pose_file], one frame a row otherwise    every *.csv (profiles),
//   or every *.png *.bmp *.tif *.tiff *.pgm *.jpg (images), in natural order
//                (frame2 before frame10). The spot id is the file's name without extension.
// Where there are no CSVs, profiles are the files of the first of these kinds that is there: .tsv .npy .ply
// .pcd .asc .xyz .dat .txt (profile_layout.h); a folder of profiles of several kinds is an Error. A single file with several profiles stands for a folder: its
// profiles are the frames, their spot ids the numbers that the file gives them ("3"), or its stem where there
// is only one. A table of all poses (pose_table.h), named in the layout or called poses.{csv,txt,dat,mod,ls,json},
// counts before pose files. Without a manifest, and where the manifest names no pose, the pose of
// frame0007.png is looked for as frame0007.{json,txt,yaml,yml}, pose0007.{..} and poses/0007.{..} beside or
// one folder above it (pose_json.h says what the formats mean). Either every frame has a pose or none: a
// folder where some are missing is an Error, since a spot measured at an assumed pose would move a robot
// wrongly.
//
// Names in a manifest must stay inside the folder. Files are opened only when replayed; one that cannot be
// read gives a frame of status corrupt.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "devices/device_session.h"
#include "devices/exchange/settings.h"
#include "devices/profile_source.h"
#include "devices/replay/recording_layout.h"
#include "devices/robot_link.h"

namespace seamwright {

struct RecordedFrame {
    std::filesystem::path file;
    std::string spot_id;
    std::optional<Pose> base_from_flange;
    bool image = false;                      // else a profile
    std::shared_ptr<const Profile> profile;  // of a file with several: read with the list
};

// Less-than with runs of digits compared as numbers ("frame2" < "frame10").
bool natural_less(std::string_view a, std::string_view b);

// `kind`: "profiles", "images" or "" (either, but not both in one folder).
// `told`, where given, becomes what was understood, a sentence each.
Expected<std::vector<RecordedFrame>> list_recording(const std::filesystem::path& folder,
                                                    const std::string& kind, bool poses_required,
                                                    const RecordingLayout& layout = {},
                                                    std::vector<std::string>* told = nullptr);

// What the replayed sensor and robot share. Thread-safe.
//
// Without a robot the frames come in order. Once the robot has started a measuring move list, frames come as
// the robot "fires": each move plays the next frame of its spot id, and the sensor delivers exactly the
// frames of the events that the robot has handed out, in that order.
class Recording {
  public:
    Recording(std::filesystem::path folder, std::vector<RecordedFrame> frames, bool loop);

    const std::filesystem::path& folder() const { return folder_; }
    bool loop() const { return loop_; }
    const std::vector<RecordedFrame>& frames() const { return frames_; }

    // Robot's side. Error when a spot is not in the recording, or has no frame left.
    Expected<void> start_moves(const std::vector<std::string>& spot_ids);
    // Next frame of the move list, now due at the sensor; nullptr when the list is done.
    const RecordedFrame* fire();

    // Sensor's side. A software trigger makes the next frame of that spot due ("" = next of all), unless the
    // robot's trigger for the same spot is still waiting to be served: that is the same exposure.
    Expected<void> trigger(const std::string& spot_id);
    enum class Next { frame, nothing_due, ended };
    Next next(const RecordedFrame*& frame);     // takes it
    void put_back(const RecordedFrame* frame);  // could not be delivered; comes again

  private:
    Expected<std::size_t> take(const std::string& spot_id);  // precondition: locked
    std::filesystem::path folder_;
    std::vector<RecordedFrame> frames_;
    bool loop_;
    mutable std::mutex mutex_;
    std::map<std::string, std::vector<std::size_t>> of_spot_;
    std::map<std::string, std::size_t> played_;  // per spot
    std::size_t cursor_ = 0;                     // in-order playing
    bool driven_ = false;                        // by robot or software trigger
    std::deque<std::size_t> moves_;
    std::deque<std::size_t> due_;
};

// Settings of sensor and robot, both with the same "folder", or "file" (capture_replay.h).
const SettingTable& replay_sensor_settings();
const SettingTable& replay_robot_settings();
// The robot writes no frames, since there is no controller behind it, unless "accept_frames" is true: then it
// keeps them in memory and reads them back, which proves nothing about a real controller. "frames" are those
// it starts with.
Expected<std::unique_ptr<ProfileSource>> open_replay_sensor(const nlohmann::json& settings,
                                                            DeviceSession& session);
Expected<std::unique_ptr<RobotLink>> open_replay_robot(const nlohmann::json& settings,
                                                       DeviceSession& session);

}  // namespace seamwright
