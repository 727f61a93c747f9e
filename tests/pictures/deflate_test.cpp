// Compressed bytes, taken apart by zlib.

#include "raymarch/files/deflate.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <memory>
#include <random>

#include "tests/random_seed.h"

namespace limn::test {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// Runs, repetitions from farther back, and noise, in shares that differ from call to call.
Bytes some_bytes(size_t count, std::mt19937& random) {
  Bytes bytes;
  const unsigned kinds = 1 + static_cast<unsigned>(random() % 3), values = 1 + static_cast<unsigned>(random() % 256);
  while (bytes.size() < count) {
    const size_t length = std::min<size_t>(1 + random() % 700, count - bytes.size());
    const unsigned kind = static_cast<unsigned>(random() % kinds);
    const auto value = static_cast<std::uint8_t>(random() % values);
    const size_t back = bytes.empty() ? 0 : 1 + random() % std::min<size_t>(bytes.size(), 40000);
    for (size_t i = 0; i < length; ++i)
      bytes.push_back(kind == 0 || bytes.empty() ? value : kind == 1 ? static_cast<std::uint8_t>(random()) : bytes[bytes.size() - back]);
  }
  return bytes;
}

/// A negative window means a raw stream, as zlib has it.
Bytes inflated(const Bytes& compressed, size_t size, int window) {
  Bytes bytes(size + 1);
  z_stream stream{};
  EXPECT_EQ(inflateInit2(&stream, window), Z_OK);
  stream.next_in = const_cast<std::uint8_t*>(compressed.data());
  stream.avail_in = static_cast<uInt>(compressed.size());
  stream.next_out = bytes.data();
  stream.avail_out = static_cast<uInt>(bytes.size());
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END) << (stream.msg != nullptr ? stream.msg : "");
  EXPECT_EQ(stream.avail_in, 0u);
  bytes.resize(stream.total_out);
  inflateEnd(&stream);
  return bytes;
}

TEST(Deflate, ZlibReadsStreamsAndParts) {
  std::mt19937 random(random_seed());
  Deflater deflater;
  for (int trial = 0; trial < 60; ++trial) {
    Bytes plain, raw;
    const int parts = 1 + static_cast<int>(random() % 4);
    for (int part = 0; part < parts; ++part) {
      const size_t sizes[] = {0, 1, 2, random() % 100, random() % 70000, random() % 600000};
      const Bytes bytes = some_bytes(sizes[random() % std::size(sizes)], random);
      plain.insert(plain.end(), bytes.begin(), bytes.end());
      if (part + 1 < parts && random() % 3 == 0) {
        const Bytes compressed = compress_runs(bytes);
        raw.insert(raw.end(), compressed.begin(), compressed.end());
        continue;
      }
      const std::span compressed = deflater.compress(bytes, part + 1 < parts ? DeflatePart::inner : DeflatePart::last);
      raw.insert(raw.end(), compressed.begin(), compressed.end());
    }
    ASSERT_EQ(inflated(raw, plain.size(), -15), plain) << "trial " << trial;
    const std::span whole = deflater.compress(plain, DeflatePart::whole_stream);
    ASSERT_EQ(inflated({whole.begin(), whole.end()}, plain.size(), 15), plain) << "trial " << trial;
    ASSERT_EQ(adler32_of(plain), adler32(1, plain.data(), static_cast<uInt>(plain.size())));
  }
}

TEST(Deflate, BytesDoNotDependOnWhatWasCompressedBefore) {
  std::mt19937 random(random_seed());
  Deflater used;
  for (int trial = 0; trial < 60; ++trial) {
    const Bytes bytes = some_bytes(random() % 300000, random);
    Deflater fresh;
    for (const DeflatePart part : {DeflatePart::inner, DeflatePart::last, DeflatePart::whole_stream}) {
      const std::span once = fresh.compress(bytes, part), again = used.compress(bytes, part);
      ASSERT_TRUE(std::equal(once.begin(), once.end(), again.begin(), again.end())) << "trial " << trial;
    }
  }
}

/// Rows of a small picture as its filters leave them: an object before nothing.
Bytes some_rows(std::mt19937& random) {
  constexpr unsigned kChannels = 4;
  const unsigned width = 8 + static_cast<unsigned>(random() % 24), height = 6 + static_cast<unsigned>(random() % 20);
  Bytes bytes;
  for (unsigned y = 0; y < height; ++y) {
    bytes.push_back(static_cast<std::uint8_t>(random() % 3));
    const auto left = static_cast<unsigned>(random() % width), right = left + static_cast<unsigned>(random() % (width - left + 1));
    for (unsigned i = 0; i < kChannels * width; ++i) {
      const unsigned x = i / kChannels;
      const bool seen = x >= left && x < right, edge = x == left;
      const auto color = static_cast<std::uint8_t>(edge ? random() : random() % 7 - 3);
      bytes.push_back(!seen ? std::uint8_t{0} : i % kChannels < 3 ? color : static_cast<std::uint8_t>(edge ? 255 : 0));
    }
  }
  return bytes;
}

TEST(Deflate, BytesDoNotDependOnWhereTheyAreMade) {
  std::mt19937 random(random_seed());
  std::vector<Bytes> all;
  for (int i = 0; i < 20; ++i) all.push_back(some_rows(random));
  // Kept until the end, each in a place of its own: igzip's level 1 makes other bytes at one place of 2,000 (ISA-L 2.30).
  std::vector<std::unique_ptr<Deflater>> deflaters;
  std::vector<Bytes> first;
  for (int place = 0; place < 1000; ++place) {
    Deflater& deflater = *deflaters.emplace_back(std::make_unique<Deflater>());
    for (size_t i = 0; i < all.size(); ++i) {
      const std::span compressed = deflater.compress(all[i], DeflatePart::whole_stream);
      if (place == 0) first.emplace_back(compressed.begin(), compressed.end());
      ASSERT_TRUE(std::equal(compressed.begin(), compressed.end(), first[i].begin(), first[i].end())) << "place " << place;
    }
  }
}

TEST(Deflate, NoiseGrowsByLittleAndRunsShrinkToNothing) {
  std::mt19937 random(random_seed());
  Deflater deflater;
  Bytes noise(300000);
  for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random());
  EXPECT_LT(deflater.compress(noise, DeflatePart::whole_stream).size(), noise.size() + noise.size() / 50);
  EXPECT_LT(deflater.compress(Bytes(300000, 7), DeflatePart::whole_stream).size(), 3000u);
  EXPECT_LT(compress_runs(Bytes(300000, 7)).size(), 500u);
}

}  // namespace
}  // namespace limn::test
