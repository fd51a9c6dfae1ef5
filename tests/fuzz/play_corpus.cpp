// The fuzz targets without a fuzzer: every file of the corpus, then as many changed ones as asked for.
//   fuzz_X_smoke CORPUS RUNS

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
    if (argc != 3) return 2;
    std::vector<std::vector<std::uint8_t>> corpus = {{}};
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
        std::ifstream in(entry.path(), std::ios::binary);
        corpus.emplace_back(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    }
    for (const auto& input : corpus) LLVMFuzzerTestOneInput(input.data(), input.size());
    std::mt19937 random(1);
    const int runs = std::atoi(argv[2]);
    for (int run = 0; run < runs; ++run) {
        std::vector<std::uint8_t> input = corpus[random() % corpus.size()];
        for (unsigned change = random() % 8 + 1; change-- > 0;) {
            const std::size_t at = input.empty() ? 0 : random() % input.size();
            switch (random() % 5) {
                case 0:
                    input.insert(input.begin() + static_cast<long>(at), static_cast<std::uint8_t>(random()));
                    break;
                case 1:
                    if (!input.empty()) input.erase(input.begin() + static_cast<long>(at));
                    break;
                case 2:
                    input.resize(at);
                    break;
                case 3: {
                    const auto& other = corpus[random() % corpus.size()];
                    input.insert(input.end(), other.begin(), other.end());
                    break;
                }
                default:
                    if (!input.empty()) input[at] ^= static_cast<std::uint8_t>(1U << random() % 8);
            }
        }
        LLVMFuzzerTestOneInput(input.data(), input.size());
    }
    std::printf("%zu of the corpus, %d changed\n", corpus.size() - 1, runs);
    return 0;
}
