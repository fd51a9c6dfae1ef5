// A capture from outside: refused or read; the checksums of its blocks hold what is read.

#include "devices/capture/recorder.h"
#include "tests/fuzz/patched_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace seamwright;
    static PatchedFile file("fuzz_capture", [](const std::filesystem::path& path) {
        auto recorder = Recorder::create(path, {.images = true, .compress = true});
        if (!recorder) std::abort();
        const auto sensor = (*recorder)->add_sensor("A", {});
        const auto robot = (*recorder)->add_robot("R1", {});
        if (!sensor || !robot) std::abort();
        Frame frame;
        for (std::uint64_t n = 1; n <= 20; ++n) {
            frame.sequence = n;
            frame.spot_id = n % 5 == 0 ? "S1" : "";
            frame.profile.clear();
            for (int i = 0; i < 50; ++i) {
                frame.profile.x_mm.push_back(i);
                frame.profile.z_mm.push_back(static_cast<double>(n));
            }
            (*recorder)->frame(*sensor, frame);
        }
        (*recorder)->event({*robot, CaptureEventKind::trigger, 1, "S1", "", Pose::Identity()});
        if (!(*recorder)->finish()) std::abort();
    });
    auto reader = CaptureReader::open(file.with(data, size));
    if (!reader) return 0;
    for (const CaptureSource& source : reader->sources()) {
        const std::uint64_t frames = std::min<std::uint64_t>(reader->frames(source.id), 1000);
        for (std::uint64_t i = 0; i < frames; ++i)
            if (const auto frame = reader->frame(source.id, i);
                frame && (*frame)->profile.size() > (1U << 24))
                std::abort();
        (void)reader->spots(source.id);
    }
    (void)reader->events();
    (void)reader->check();
    return 0;
}
