// voxel_image.cpp: the header of a .npy file, which is a Python dictionary; and VTK's XML with raw bytes behind it.
#include "io/voxel_image.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <fstream>
#include <sstream>

#include "core/parallel.h"

namespace kiln::io {

namespace {

constexpr char magic[] = "\x93NUMPY";
constexpr std::size_t magic_size = 6, max_header = 1 << 16;

/// The text after 'key': in the dictionary, up to what may end it.
std::string value_of(const std::string& header, const std::string& key, const std::string& file) {
    const std::size_t name = header.find("'" + key + "':");
    if (name == std::string::npos) throw Error(file + ": the header of this .npy file has no '" + key + "'");
    const std::size_t begin = header.find_first_not_of(' ', name + key.size() + 3);
    if (begin == std::string::npos) throw Error(file + ": the header of this .npy file ends early");
    const std::size_t end = header.find(header[begin] == '(' ? ')' : ',', begin);
    return header.substr(begin, end == std::string::npos ? end : end - begin);
}

std::vector<std::size_t> numbers_of(const std::string& text, const std::string& file) {
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < text.size();) {
        if (text[i] < '0' || text[i] > '9') {
            ++i;
            continue;
        }
        std::size_t number = 0;
        const auto [end, error] = std::from_chars(text.data() + i, text.data() + text.size(), number);
        if (error != std::errc()) throw Error(file + ": a number of the array's shape is too large");
        numbers.push_back(number);
        i = static_cast<std::size_t>(end - text.data());
    }
    return numbers;
}

std::string read_header(std::istream& stream, const std::string& file) {
    char start[magic_size + 2] = {};
    stream.read(start, sizeof start);
    if (!stream || std::memcmp(start, magic, magic_size) != 0) throw Error(file + ": this is not a .npy file");
    unsigned char size_bytes[4] = {};
    stream.read(reinterpret_cast<char*>(size_bytes), start[magic_size] == 1 ? 2 : 4);
    std::size_t size = 0;
    for (std::size_t i = 4; i-- > 0;) size = size << 8 | size_bytes[i];
    if (!stream || size > max_header) throw Error(file + ": the header of this .npy file is damaged");
    std::string header(size, ' ');
    stream.read(header.data(), static_cast<std::streamsize>(size));
    if (!stream) throw Error(file + ": the file ends within its header");
    return header;
}

std::uint64_t bytes_left(std::istream& stream) {
    const std::streampos here = stream.tellg();
    stream.seekg(0, std::ios::end);
    const std::streampos end = stream.tellg();
    stream.seekg(here);
    return static_cast<std::uint64_t>(end - here);
}

/// From the order in which the last index runs fastest to that in which the first does.
std::vector<std::uint8_t> first_fastest(const std::vector<std::uint8_t>& values, const std::array<std::size_t, 3>& shape) {
    std::vector<std::uint8_t> turned(values.size());
    const auto [n0, n1, n2] = shape;
    for_chunks(n2, [&, n0 = n0, n1 = n1, n2 = n2](std::size_t k) {
        for (std::size_t j = 0; j < n1; ++j)
            for (std::size_t i = 0; i < n0; ++i) turned[i + n0 * (j + n1 * k)] = values[k + n2 * (j + n1 * i)];
    });
    return turned;
}

}  // namespace

ByteImage read_npy_mask(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error(file + " cannot be read");
    const std::string header = read_header(stream, file);
    const std::string type = value_of(header, "descr", file), order = value_of(header, "fortran_order", file);
    const std::vector<std::size_t> shape = numbers_of(value_of(header, "shape", file), file);
    if (type != "'|u1'" && type != "'|i1'" && type != "'|b1'")
        throw Error(file + ": the array's type is " + type + "; an image has bytes or booleans, '|u1', '|i1' or '|b1'");
    if (shape.size() != 3)
        throw Error(file + ": the array has " + std::to_string(shape.size()) + " dimensions; an image has 3");
    ByteImage image;
    std::copy_n(shape.begin(), 3, image.shape.begin());
    const std::uint64_t left = bytes_left(stream);
    std::uint64_t size = 1;
    if (std::find(shape.begin(), shape.end(), 0) != shape.end()) throw Error(file + ": the image is empty");
    for (const std::size_t each : shape) {
        if (size > left / each) throw Error(file + ": the file ends before its array does");
        size *= each;
    }
    if (size != left) throw Error(file + ": " + std::to_string(left - size) + " bytes stand behind the array");
    image.values.resize(size);
    stream.read(reinterpret_cast<char*>(image.values.data()), static_cast<std::streamsize>(size));
    if (!stream) throw Error(file + " cannot be read to its end");
    const auto wrong = std::find_if(image.values.begin(), image.values.end(), [](std::uint8_t value) { return value > 1; });
    if (wrong != image.values.end())
        throw Error(file + ": value " + std::to_string(wrong - image.values.begin()) + " of the array is " +
                    std::to_string(*wrong) + "; voxels are 0, void, or 1, solid");
    if (order != "True") image.values = first_fastest(image.values, image.shape);
    return image;
}

std::string npy_bytes(const ByteImage& image) {
    std::string header = "{'descr': '|u1', 'fortran_order': True, 'shape': (" + std::to_string(image.shape[0]) + ", " +
                         std::to_string(image.shape[1]) + ", " + std::to_string(image.shape[2]) + "), }";
    constexpr std::size_t alignment = 64, before = magic_size + 4;
    header += std::string(alignment - (before + header.size() + 1) % alignment, ' ') + "\n";
    std::string bytes(magic, magic_size);
    bytes += {'\x01', '\x00', static_cast<char>(header.size() & 0xff), static_cast<char>(header.size() >> 8)};
    bytes += header;
    bytes.append(reinterpret_cast<const char*>(image.values.data()), image.values.size());
    return bytes;
}

std::string vti_bytes(const ByteImage& image, const Vec3& origin, const Vec3& edges, const std::string& name) {
    std::ostringstream text;
    text.precision(17);
    text << "<?xml version=\"1.0\"?>\n"
         << "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";
    const std::string extent = "0 " + std::to_string(image.shape[0]) + " 0 " + std::to_string(image.shape[1]) + " 0 " +
                               std::to_string(image.shape[2]);
    text << "<ImageData WholeExtent=\"" << extent << "\" Origin=\"" << origin[0] << " " << origin[1] << " " << origin[2]
         << "\" Spacing=\"" << edges[0] << " " << edges[1] << " " << edges[2] << "\">\n"
         << "<Piece Extent=\"" << extent << "\">\n<CellData Scalars=\"" << name << "\">\n"
         << "<DataArray type=\"UInt8\" Name=\"" << name << "\" format=\"appended\" offset=\"0\"/>\n"
         << "</CellData>\n</Piece>\n</ImageData>\n<AppendedData encoding=\"raw\">\n_";
    std::string bytes = text.str();
    const std::uint64_t size = image.values.size();
    for (int byte = 0; byte < 8; ++byte) bytes += static_cast<char>(size >> (8 * byte) & 0xff);
    bytes.append(reinterpret_cast<const char*>(image.values.data()), image.values.size());
    return bytes + "\n</AppendedData>\n</VTKFile>\n";
}

}  // namespace kiln::io
