#include "tests/projects/file/replay_store.h"

namespace seamwright {

TEST(ReplayLong, TenThousandProfiles) {
    TemporaryFolder folder;
    store_runs(folder / "a.seam", 250, 40);
    expect_reproduced(folder / "a.seam", 250, 40);
}

}  // namespace seamwright
