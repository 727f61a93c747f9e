"""What damage does to bytes."""
import re
import struct

TELLING = (0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x00010000, 0x7FC00000, 0x7F800000)
TELLING_TEXT = (b"0", b"-1", b"nan", b"inf", b"1e308", b"-1e-320", b"2147483648", b"4294967295", b"99999999999999999999", b"0.5", b"\"\"", b"[]")
NUMBER = re.compile(rb"-?\d+(\.\d+)?([eE][-+]?\d+)?")
WAYS = ("bits flipped", "cut short", "a run doubled", "a run taken out", "32 bits set", "a number set")


def once(data, way, random_numbers):
    at = random_numbers.randrange(len(data))
    length = min(random_numbers.choice((1, 4, 16, 64, 256)), len(data) - at)
    if way == 0:
        for _ in range(random_numbers.choice((1, 2, 8))):
            data[random_numbers.randrange(len(data))] ^= 1 << random_numbers.randrange(8)
    elif way == 1:
        del data[at:]
    elif way == 2:
        data[at:at] = data[at:at + length]
    elif way == 3:
        del data[at:at + length]
    elif way == 4:
        data[at:at + 4] = struct.pack(random_numbers.choice(("<I", ">I")), random_numbers.choice(TELLING))
    else:
        numbers = list(NUMBER.finditer(data))
        if numbers:
            first, last = random_numbers.choice(numbers).span()
            data[first:last] = random_numbers.choice(TELLING_TEXT)


def damage(data, is_text, random_numbers):
    """One to three of the ways; the last of them is for text, which seldom gets past its parser otherwise."""
    data = bytearray(data)
    for _ in range(random_numbers.choice((1, 1, 1, 2, 3))):
        if data:
            way = 5 if is_text and random_numbers.random() < 0.5 else random_numbers.randrange(5)
            once(data, way, random_numbers)
    return bytes(data)
