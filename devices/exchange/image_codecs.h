#pragma once
// OpenCV's codecs for images. They pull a hundred and forty shared libraries along (GDAL's among them), a tenth of a second
// of every start: they are read from disk with the first image.

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "core/error.h"

namespace seamwright {

inline constexpr std::size_t kMostImagePixels = std::size_t{1} << 26;

// What the bytes of an image file hold, channels and depth as stored, turned by no tag. Empty where they are no image. Throws
// cv::Exception or std::bad_alloc where the header lies. Error (file): this installation is without its codecs.
Expected<cv::Mat> decode_image(const std::string& bytes);

// The bytes of an image file of the format that the extension (".png") names; none where there is no such format. Throws
// cv::Exception. Error (file): this installation is without its codecs.
Expected<std::vector<unsigned char>> encode_image(const std::filesystem::path& extension,
                                                  const cv::Mat& image);

// What seamwright_codecs.so (core/loaded_object.h) hands out.
extern "C" {
void seamwright_decode_image(const std::string& bytes, cv::Mat& image);
// False: there is no such format.
bool seamwright_encode_image(const std::string& extension, const cv::Mat& image,
                             std::vector<unsigned char>& bytes);
}

}  // namespace seamwright
