// nodes7 against the program of this folder. Argument: the port.
const assert = require("assert");
const NodeS7 = require("nodes7");

const fail = (error) => { console.error(error); process.exit(1); };
setTimeout(() => fail("no answer within 20 s"), 20000).unref();
process.on("uncaughtException", fail);

const client = new NodeS7({ silent: true });
// More items than one PDU has, of all types, in several blocks.
const items = { word: "MW10", real: "DB2,REAL4", bit: "DB2,X8.0", cycles: "DB2,DINT0", ends: "DB4,INT0.100" };
for (let index = 0; index < 25; index++) items["byte" + index] = "DB1,B" + 100 * index;
client.initiateConnection({ port: Number(process.argv[2]), host: "127.0.0.1", rack: 0, slot: 2 }, (error) => {
  if (error) fail(error);
  client.setTranslationCB((name) => items[name]);
  client.addItems(Object.keys(items));
  const names = [...Array(25).keys()].map((index) => "byte" + index).concat(["word"]);
  const values = names.map((name, index) => 10 + index);
  client.writeItems(names, values, (bad) => {
    if (bad) fail("bad qualities on writing");
    client.readAllItems((bad, read) => {
      try {
        assert(!bad, "bad qualities on reading: " + JSON.stringify(read));
        names.forEach((name, index) => assert.strictEqual(read[name], values[index], name));
        assert.strictEqual(read.real, 1.5);
        assert.strictEqual(read.bit, true);
        assert(read.cycles > 0);
        assert.strictEqual(read.ends[0], read.ends[99]);
      } catch (error) { fail(error); }
      client.dropConnection(() => { console.log("done"); process.exit(0); });
    });
  });
});
