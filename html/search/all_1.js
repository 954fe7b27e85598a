var searchData=
[
  ['hyperfocal_0',['hyperfocal',['../md_README.html',1,'']]]
];
