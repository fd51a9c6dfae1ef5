#include "widgets/picture_file.h"

#include <QBuffer>

#include "devices/exchange/files.h"

namespace seamwright {

Expected<void> write_picture(const QImage& image, const std::filesystem::path& png) {
    QBuffer buffer;
    buffer.open(QIODevice::WriteOnly);
    if (!image.save(&buffer, "PNG")) return file_error("the image cannot be encoded", png.string());
    const QByteArray& bytes = buffer.data();
    return write_text_file(png, std::string_view(bytes.constData(), static_cast<std::size_t>(bytes.size())));
}

}  // namespace seamwright
