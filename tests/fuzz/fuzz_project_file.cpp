// A project file from outside: refused or read, whatever its bytes; what loads is a project that can be
// written again.

#include "projects/file/project_file.h"
#include "projects/file/project_json.h"
#include "tests/fuzz/patched_file.h"
#include "tests/projects/sample_project.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace seamwright;
    static PatchedFile file("fuzz_project_file", [](const std::filesystem::path& path) {
        // One of everything: a small file is a fast one.
        Project project = sample_project();
        project.part.mesh_ply.resize(50);
        project.spots.resize(2);
        for (Spot& spot : project.spots) {
            spot.reference_profile = SampleMaker(1).profile(5);
            spot.feature.template_profile = SampleMaker(2).profile(5);
        }
        project.regions[0].spot_ids = {"S1", "S2"};
        auto made = ProjectFile::create(path, project);
        if (!made) std::abort();
        if (!made->append_run(sample_run(1, 2, 5), project)) std::abort();
    });
    auto opened = ProjectFile::open(file.with(data, size), FileAccess::read_only);
    if (!opened) return 0;
    // check() reads whatever the file holds: project, setups, runs, captures, events, evidence.
    (void)opened->check();
    return 0;
}
