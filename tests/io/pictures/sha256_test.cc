#include "io/pictures/sha256.h"

#include <gtest/gtest.h>

#include <string>

#include "io/pictures/document.h"

namespace trilobe::TRILOBE_TEST_FILE {
namespace {

// Hashes of FIPS 180-4's examples, and of lengths about that of a block, by Python's hashlib.
TEST(Sha256, IsThatOfOthers) {
  EXPECT_EQ(Base64(Sha256("")), "47DEQpj8HBSa+/TImW+5JCeuQeRkm5NMpJWZG3hSuFU=");
  EXPECT_EQ(Base64(Sha256("abc")), "ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=");
  EXPECT_EQ(Base64(Sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "JI1qYdIGOLjlwCaTDD5gOaM85Flk/yFn9uzt1BnbBsE=");
  EXPECT_EQ(Base64(Sha256(std::string(55, '0'))), "n474dvUfUxPJHMP2uBGa8J2LvdcgmPoUmyeA6zWR1r4=");
  EXPECT_EQ(Base64(Sha256(std::string(56, '0'))), "vQOsFCjw6ob0uDpzH/x5Z7uChm2FRTIviI0vboV//Bg=");
  EXPECT_EQ(Base64(Sha256(std::string(63, '0'))), "x9wtJeMGNVyXr5FujVCyepSFBqdMay3Rsp4rY9Cjqow=");
  EXPECT_EQ(Base64(Sha256(std::string(64, '0'))), "YOBb0bGVry+UES+nGXpciCiQWIQM58bflpN1a8YlD1U=");
  EXPECT_EQ(Base64(Sha256(std::string(119, '0'))), "xEh/nWQg41aY+dm0lS4Kn0c1sM4XKc3GhnL/MPIMavI=");
  EXPECT_EQ(Base64(Sha256(std::string(1000, '0'))), "wxvKRWluC0dlQnIppf2umj+Nyhl06bmSKccM+JmpDmg=");
}

}  // namespace
}  // namespace trilobe::TRILOBE_TEST_FILE
