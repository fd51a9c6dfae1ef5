#include "devices/drawing/shape_reader.h"

#include <IGESControl_Reader.hxx>
#include <IGESData_IGESModel.hxx>
#include <Interface_Static.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_SequenceOfAsciiString.hxx>
#include <algorithm>
#include <cctype>
#include <fstream>
#include <istream>
#include <span>
#include <streambuf>
#include <string_view>

#include "devices/drawing/apart.h"
#include "devices/drawing/occt_progress.h"
#include "devices/drawing/shape_drawing.h"
#include "devices/drawing/step_text.h"

namespace seamwright::drawing {
namespace {

// The bytes in slices, so that the parser, which asks nobody, can be stopped: a cancelled file just ends.
class SlicedBytes : public std::streambuf {
  public:
    SlicedBytes(std::span<const std::byte> bytes, const DrawingOptions& options)
        : bytes_(bytes), options_(options) {}

  protected:
    int_type underflow() override {
        if (at_ >= bytes_.size() || options_.cancel.stop_requested()) return traits_type::eof();
        tell(options_, 0.4 * static_cast<double>(at_) / static_cast<double>(bytes_.size()), "reading");
        const std::size_t length = std::min(kSlice, bytes_.size() - at_);
        // A stream buffer that is never written to.
        char* first = const_cast<char*>(reinterpret_cast<const char*>(bytes_.data() + at_));
        setg(first, first, first + length);
        at_ += length;
        return traits_type::to_int_type(*first);
    }

  private:
    static constexpr std::size_t kSlice = std::size_t{1} << 18;
    std::span<const std::byte> bytes_;
    const DrawingOptions& options_;
    std::size_t at_ = 0;
};

std::string lower(std::string word) {
    std::transform(word.begin(), word.end(), word.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return word;
}

std::string_view view_of(std::span<const std::byte> bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// What FILE_SCHEMA names, for the sentence that nothing was found in it.
std::string schema_of(std::string_view text) {
    const std::size_t at = text.find("FILE_SCHEMA");
    if (at == std::string_view::npos) return {};
    const std::size_t open = text.find('\'', at), end = text.find(';', at);
    if (open == std::string_view::npos || open > end) return {};
    const std::size_t close = text.find('\'', open + 1);
    if (close == std::string_view::npos || close - open > 200) return {};
    return std::string(text.substr(open + 1, close - open - 1));
}

Expected<void> check_step(std::string_view text, const std::string& name) {
    const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
    if (first == std::string_view::npos || text.substr(first, 12) != "ISO-10303-21")
        return file_error("is no STEP file: it does not begin with ISO-10303-21", name,
                          "export it as STEP (AP203, AP214 or AP242)");
    const std::size_t last = text.rfind("END-ISO-10303-21");
    if (last == std::string_view::npos || last + 4096 < text.size())
        return file_error("is cut off: END-ISO-10303-21 is missing at its end", name, "copy it again");
    return {};
}

constexpr double kPatienceS = 30, kPatienceSPerByte = 10e-6;

// Whatever OpenCASCADE throws.
template <class F>
Expected<Drawing> caught(const std::string& name, const DrawingOptions& options, const F& read) {
    try {
        return read(options);
    } catch (const Standard_Failure& e) {
        return file_error(Text("cannot be read (OpenCASCADE: {})",
                               std::string(e.GetMessageString() ? e.GetMessageString() : "")),
                          name, "export it again from the drawing program");
    } catch (const std::bad_alloc&) {
        return file_error("cannot be read: there is not enough memory for it", name);
    } catch (const std::exception& e) {
        return file_error(Text("cannot be read ({})", std::string(e.what())), name);
    }
}

template <class F>
Expected<Drawing> guarded(std::size_t bytes, const std::string& name, DrawingOptions options, const F& read) {
    const Quiet quiet;
    if (options.patience_s == 0)
        options.patience_s = kPatienceS + kPatienceSPerByte * static_cast<double>(bytes);
    return read_apart(name, options, [&](const DrawingOptions& here) { return caught(name, here, read); });
}

}  // namespace

Expected<Drawing> read_step(std::span<const std::byte> bytes, const std::string& name,
                            const DrawingOptions& given) {
    SEAM_OK(check_step(view_of(bytes), name));
    return guarded(bytes.size(), name, given, [&](const DrawingOptions& options) -> Expected<Drawing> {
        STEPControl_Reader reader;
        Interface_Static::SetCVal("xstep.cascade.unit", "MM");
        SlicedBytes buffer(bytes, options);
        std::istream stream(&buffer);
        const IFSelect_ReturnStatus status = reader.ReadStream(name.c_str(), stream);
        if (options.cancel.stop_requested()) return cancelled(name);
        if (status != IFSelect_RetDone)
            return file_error("cannot be read: its entities are not those of a STEP file", name,
                              "export it again from the drawing program");
        const Handle(Watcher) watcher = new Watcher(options, 0.4, 0.6, "building shapes");
        reader.TransferRoots(watcher->Start());
        if (options.cancel.stop_requested()) return cancelled(name);
        const TopoDS_Shape shape = reader.OneShape();
        if (shape.IsNull())
            return file_error(Text("holds no shape (its schema is \"{}\")", schema_of(view_of(bytes))), name,
                              "export the part as a solid or as surfaces (AP203, AP214, AP242)");
        auto drawing = drawing_of(shape, name, options);
        if (!drawing) return drawing;
        drawing->form = "step";
        TColStd_SequenceOfAsciiString lengths, angles, solid_angles;
        reader.FileUnits(lengths, angles, solid_angles);
        drawing->unit = lengths.IsEmpty() ? "millimetre" : lower(lengths.First().ToCString());
        return drawing;
    });
}

Expected<Drawing> read_iges(std::span<const std::byte> bytes, const std::string& name,
                            const DrawingOptions& given) {
    const std::string_view text = view_of(bytes);
    const std::size_t last = text.find_last_not_of(" \t\r\n\x1A");
    const std::size_t line = last == std::string_view::npos ? 0 : text.find_last_of("\r\n", last);
    if (text.size() < 80 || text[72] != 'S')
        return file_error("is no IGES file: column 73 of its first line is not S", name,
                          "export it as STEP or IGES");
    if (line == std::string_view::npos || last < line + 73 || text[line + 73] != 'T')
        return file_error("is cut off: it does not end with the line that IGES ends with", name,
                          "copy it again");
    return guarded(bytes.size(), name, given, [&](const DrawingOptions& options) -> Expected<Drawing> {
        // This reader knows files alone.
        const TemporaryFile file;
        if (!file.ok()) return file_error("no file can be made there", file.path());
        {
            std::ofstream out(file.path(), std::ios::binary);
            out.write(text.data(), static_cast<std::streamsize>(text.size()));
            if (!out) return file_error("could not be written", file.path());
        }
        tell(options, 0, "reading");
        IGESControl_Reader reader;
        Interface_Static::SetCVal("xstep.cascade.unit", "MM");
        const IFSelect_ReturnStatus status = reader.ReadFile(file.path().c_str());
        if (options.cancel.stop_requested()) return cancelled(name);
        if (status != IFSelect_RetDone)
            return file_error("cannot be read: its entities are not those of an IGES file", name,
                              "export it again from the drawing program");
        const Handle(Watcher) watcher = new Watcher(options, 0.4, 0.6, "building shapes");
        reader.TransferRoots(watcher->Start());
        if (options.cancel.stop_requested()) return cancelled(name);
        const TopoDS_Shape shape = reader.OneShape();
        if (shape.IsNull())
            return file_error("holds no shape", name, "export the part as a solid or as surfaces");
        auto drawing = drawing_of(shape, name, options);
        if (!drawing) return drawing;
        drawing->form = "iges";
        const Handle(IGESData_IGESModel) model = Handle(IGESData_IGESModel)::DownCast(reader.Model());
        if (!model.IsNull() && !model->GlobalSection().UnitName().IsNull())
            drawing->unit = lower(model->GlobalSection().UnitName()->ToCString());
        return drawing;
    });
}

}  // namespace seamwright::drawing
